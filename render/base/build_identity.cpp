#include "render/base/build_identity.h"

#include <elf.h>
#include <link.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/staged_file.h"

namespace standin {
namespace {

std::size_t padded(std::size_t size) {
  return (size + 3) / 4 * 4;
}

// The bytes of the GNU build id among the notes of a segment; nothing where there is none.
std::string_view build_id_in(std::string_view notes) {
  while (notes.size() >= sizeof(ElfW(Nhdr))) {
    const auto& note = *reinterpret_cast<const ElfW(Nhdr)*>(notes.data());
    const std::size_t name_at = sizeof note;
    const std::size_t id_at = name_at + padded(note.n_namesz);
    if (id_at + note.n_descsz > notes.size()) break;
    if (note.n_type == NT_GNU_BUILD_ID && notes.substr(name_at, note.n_namesz) == std::string_view("GNU\0", 4))
      return notes.substr(id_at, note.n_descsz);
    notes.remove_prefix(std::min(notes.size(), id_at + padded(note.n_descsz)));
  }
  return {};
}

/// A file of the running program, and its build id, if it was linked with one.
struct Module {
  std::string file;
  std::string build_id;
};

std::string build_id_of(const dl_phdr_info& module) {
  for (int i = 0; i < module.dlpi_phnum; ++i) {
    const auto& segment = module.dlpi_phdr[i];
    if (segment.p_type != PT_NOTE) continue;
    const char* const start = reinterpret_cast<const char*>(module.dlpi_addr + segment.p_vaddr);
    if (const auto id = build_id_in({start, segment.p_memsz}); !id.empty()) return std::string(id);
  }
  return {};
}

int add_module(dl_phdr_info* module, std::size_t, void* modules) {
  static_cast<std::vector<Module>*>(modules)->push_back({module->dlpi_name, build_id_of(*module)});
  return 0;
}

// The kernel's own page is no code of ours, and changes with the kernel.
bool is_kernels(const Module& module) {
  return module.file.starts_with("linux-vdso");
}

std::string identity_of(const Module& module) {
  if (!module.build_id.empty()) return module.build_id;
  return fingerprint_of(read_file(module.file.empty() ? "/proc/self/exe" : module.file)).hex();
}

std::uint32_t instruction_sets() {
  std::uint32_t sets = 0;
#if defined(__x86_64__)
  __builtin_cpu_init();
  const auto note = [&](int supported) { sets = 2 * sets + (supported != 0 ? 1 : 0); };
  note(__builtin_cpu_supports("sse4.2"));
  note(__builtin_cpu_supports("avx"));
  note(__builtin_cpu_supports("avx2"));
  note(__builtin_cpu_supports("fma"));
  note(__builtin_cpu_supports("bmi2"));
  note(__builtin_cpu_supports("avx512f"));
  note(__builtin_cpu_supports("avx512bw"));
  note(__builtin_cpu_supports("avx512vl"));
#endif
  return sets;
}

// Sorted: address randomisation may change the order.
Fingerprint identify() {
  std::vector<Module> modules;
  dl_iterate_phdr(add_module, &modules);
  std::vector<std::string> identities;
  for (const Module& module : modules)
    if (!is_kernels(module)) identities.push_back(identity_of(module));
  std::ranges::sort(identities);
  Fingerprinter all;
  all.add(instruction_sets()).add(std::uint64_t{identities.size()});
  for (const std::string& identity : identities) all.add(identity);
  return all.fingerprint();
}

}  // namespace

const Fingerprint& build_identity() {
  static const Fingerprint identity = identify();
  return identity;
}

}  // namespace standin
