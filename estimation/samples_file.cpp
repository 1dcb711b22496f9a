#include "estimation/samples_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include "render/base/error.h"
#include "render/base/staged_file.h"

namespace standin {
namespace {

constexpr std::string_view kFormat = "# standin.samples 2";

constexpr std::string_view kScenes = "# scenes: ";  // the line is there where scenes were named

constexpr std::size_t kOwnColumns = 6;  // before the features

std::string text_of(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

// A value ends with its line.
std::string one_line(std::string text) {
  for (char& c : text)
    if (c == '\n' || c == '\r') c = ' ';
  return text;
}

std::string header() {
  std::string row = "group,designed,milliseconds,spread,seconds,passed_pixels";
  for (std::size_t i = 0; i < kTermCount; ++i) row += "," + std::string(term_name(static_cast<Term>(i)));
  return row;
}

/// Lines of a file, numbered from 1.
class Lines {
 public:
  Lines(std::string_view bytes, std::string file) : rest_(bytes), file_(std::move(file)) {}

  [[nodiscard]] bool at_end() const { return rest_.empty(); }
  std::string_view next() {
    ++number_;
    const std::size_t end = rest_.find('\n');
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    return line;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw Failure(ErrorWord::kFileBroken, "samples file " + file_ + ", line " + std::to_string(number_) + ": " + what);
  }

 private:
  std::string_view rest_;
  std::string file_;
  std::size_t number_ = 0;
};

std::string read_value(Lines& lines, std::string_view key) {
  const std::string start = "# " + std::string(key) + ": ";
  const std::string_view line = lines.next();
  if (!line.starts_with(start)) lines.fail("\"" + std::string(line) + "\" violates: begins with \"" + start + "\"");
  return std::string(line.substr(start.size()));
}

template <class Number>
Number read_number(const Lines& lines, std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool finite = std::isfinite(static_cast<double>(value));
  if (error != std::errc() || end != text.data() + text.size() || !finite || value < Number{})
    lines.fail("\"" + std::string(text) + "\" is not a finite number >= 0");
  return value;
}

std::vector<std::string_view> split(std::string_view row) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0; begin <= row.size();) {
    const std::size_t end = std::min(row.find(',', begin), row.size());
    cells.push_back(row.substr(begin, end - begin));
    begin = end + 1;
  }
  return cells;
}

TimedFrame read_frame(const Lines& lines, std::string_view row) {
  const auto cells = split(row);
  if (cells.size() != kTermCount + kOwnColumns)
    lines.fail(std::to_string(cells.size()) + " columns violate: " + std::to_string(kTermCount + kOwnColumns) + ", as in the header");
  TimedFrame frame;
  frame.group = read_number<std::uint32_t>(lines, cells[0]);
  frame.designed = read_number<std::uint32_t>(lines, cells[1]) != 0;
  frame.milliseconds = read_number<double>(lines, cells[2]);
  frame.spread = read_number<double>(lines, cells[3]);
  frame.seconds = read_number<double>(lines, cells[4]);
  frame.passed_pixels = read_number<double>(lines, cells[5]);
  for (std::size_t i = 0; i < kTermCount; ++i) frame.features.value[i] = read_number<double>(lines, cells[i + kOwnColumns]);
  return frame;
}

}  // namespace

void write_samples(const CalibrationSamples& samples, const std::filesystem::path& file) {
  const Machine& machine = samples.machine;
  std::string text = std::string(kFormat) + "\n# device: " + one_line(machine.device) + "\n# renderer: " + one_line(machine.renderer) +
                     "\n# gl_version: " + one_line(machine.gl_version) + "\n# processor: " + one_line(machine.processor) +
                     "\n# reference_ms: " + text_of(machine.reference_ms) + "\n# clock: " + one_line(machine.clock) + "\n" +
                     (samples.scenes.empty() ? "" : std::string(kScenes) + one_line(samples.scenes) + "\n") + header() + "\n";
  for (const TimedFrame& frame : samples.frames) {
    text += std::to_string(frame.group) + (frame.designed ? ",1" : ",0");
    for (const double value : {frame.milliseconds, frame.spread, frame.seconds, frame.passed_pixels}) text += "," + text_of(value);
    for (const double value : frame.features.value) text += "," + text_of(value);
    text += "\n";
  }
  write_file(file, text);
}

CalibrationSamples read_samples(const std::filesystem::path& file) {
  const std::string bytes = read_file(file);
  Lines lines(bytes, file.string());
  if (lines.next() != kFormat) lines.fail("violates: is \"" + std::string(kFormat) + "\"");
  CalibrationSamples samples;
  samples.machine.device = read_value(lines, "device");
  samples.machine.renderer = read_value(lines, "renderer");
  samples.machine.gl_version = read_value(lines, "gl_version");
  samples.machine.processor = read_value(lines, "processor");
  samples.machine.reference_ms = read_number<double>(lines, read_value(lines, "reference_ms"));
  if (!(samples.machine.reference_ms > 0.0)) lines.fail("reference_ms is 0, which violates: > 0");
  samples.machine.clock = read_value(lines, "clock");
  if (samples.machine.clock != "thread_cpu" && samples.machine.clock != "wall")
    lines.fail("clock \"" + samples.machine.clock + "\" violates: thread_cpu or wall");
  std::string_view row = lines.next();
  if (row.starts_with(kScenes)) {
    samples.scenes = row.substr(kScenes.size());
    row = lines.next();
  }
  if (row != header()) lines.fail("the header violates: is \"" + header() + "\"");
  while (!lines.at_end()) samples.frames.push_back(read_frame(lines, lines.next()));
  return samples;
}

}  // namespace standin
