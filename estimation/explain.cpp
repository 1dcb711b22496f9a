#include "estimation/explain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace standin {
namespace {

constexpr double kUncertain = 0.5;  // relative standard error

template <typename... Values>
std::string text(const char* format, Values... values) {
  std::array<char, 200> line{};
  std::snprintf(line.data(), line.size(), format, values...);
  return line.data();
}

/// Two significant digits, no exponent: 1500, 23, 0.4.
std::string rounded(double value) {
  if (!(value > 0.0)) return "0";
  const int digits = static_cast<int>(std::floor(std::log10(value)));
  const double unit = std::pow(10.0, digits - 1);
  return text("%.*f", std::max(0, 1 - digits), std::round(value / unit) * unit);
}

std::string duration(double milliseconds) {
  if (milliseconds >= 1.0) return rounded(milliseconds) + " ms";
  return milliseconds >= 1e-3 ? rounded(1e3 * milliseconds) + " us" : rounded(1e6 * milliseconds) + " ns";
}

class Words {
 public:
  explicit Words(const FitSummary& fit) : fit_(fit) {}

  [[nodiscard]] double ms(Term term) const { return fit_.model.milliseconds_per_unit[static_cast<std::size_t>(term)]; }

  /// "What costs 12 us", `units` of the term at a time.
  void cost(const char* what, Term term, double units = 1.0) {
    if (ms(term) > 0.0) sentences.push_back(std::string(what) + " costs " + duration(units * ms(term)) + doubt(term));
  }
  /// "One costs as much as 1,500 of the other."
  void compare(const char* one, Term term, const char* others, Term other) {
    if (ms(term) > 0.0 && ms(other) > 0.0)
      sentences.push_back(std::string(one) + " costs as much as " + rounded(ms(term) / ms(other)) + " " + others);
  }

  std::vector<std::string> sentences;

 private:
  [[nodiscard]] std::string doubt(Term term) const {
    for (const FittedTerm& fitted : fit_.terms)
      if (fitted.name == term_name(term) && fitted.relative_standard_error && *fitted.relative_standard_error > kUncertain)
        return " (+- " + text("%.0f", 100.0 * *fitted.relative_standard_error) + " %)";
    return "";
  }

  const FitSummary& fit_;
};

}  // namespace

std::vector<std::string> explain(const FitSummary& fit) {
  constexpr double kMillion = 1e6;
  Words words(fit);
  words.cost("an empty frame", Term::kFrame);
  words.cost("a draw call", Term::kDraws);
  words.compare("a draw call", Term::kDraws, "textured pixels", Term::kTexturedPixels);
  words.cost("a change of an impostor atlas's texture", Term::kTextureSwitches);
  words.compare("a texture switch", Term::kTextureSwitches, "textured pixels", Term::kTexturedPixels);
  words.cost("a million submitted triangles", Term::kTriangles, kMillion);
  words.cost("a million triangles in sight, besides,", Term::kOnScreenTriangles, kMillion);
  words.cost("a million pixels of triangle edges", Term::kEdgePixels, kMillion);
  words.cost("a million untextured pixels", Term::kPlainPixels, kMillion);
  words.cost("a million textured pixels", Term::kTexturedPixels, kMillion);
  words.cost("a million alpha-tested pixels", Term::kMaskedPixels, kMillion);
  words.cost("a million impostor pixels", Term::kImpostorPixels, kMillion);
  words.cost("a thousand impostor quads", Term::kImpostorQuads, 1e3);
  words.compare("an impostor quad", Term::kImpostorQuads, "triangles in sight", Term::kOnScreenTriangles);
  words.sentences.push_back(fit.model.combination == Combination::kSum ? "geometry and pixels add up: nothing overlaps"
                                                                       : "geometry and pixels overlap: the slower of the two counts");
  return std::move(words.sentences);
}

}  // namespace standin
