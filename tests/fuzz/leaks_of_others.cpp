// What libraries leak and we cannot mend: libpng jumps over the destructors of OpenImageIO where a PNG ends too early, and a message is
// lost.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:OpenImageIO";
}
