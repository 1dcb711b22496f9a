// Fingerprints of values: what a result was made from, in 32 bytes.
//
// A stage's result may stand in for doing the stage again where everything that the stage looked at is the same (no paper asks for that;
// who edits one object of a city does not wait for all others). Whoever names a result feeds all of its inputs to a Fingerprinter, by
// value. Every value goes in with its length or a fixed size, so that no two lists of values run into the same bytes.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "render/base/geometry.h"

namespace standin {

/// A SHA-256.
struct Fingerprint {
  std::array<std::uint8_t, 32> bytes{};

  /// Lower case.
  [[nodiscard]] std::string hex() const;
  friend auto operator<=>(const Fingerprint&, const Fingerprint&) = default;
};

/// Values whose bytes are their value: no padding, no pointers. -0.0 and 0.0 are two values.
template <class T>
concept PlainValue = std::is_arithmetic_v<T> || std::is_enum_v<T>;

class Fingerprinter {
 public:
  /// Throws Failure(kInternal) where OpenSSL offers no SHA-256.
  Fingerprinter();
  ~Fingerprinter();
  Fingerprinter(Fingerprinter&&) noexcept;
  Fingerprinter(const Fingerprinter& other);  // what was fed to the other is fed to this one
  Fingerprinter& operator=(const Fingerprinter&) = delete;

  template <PlainValue T>
  Fingerprinter& add(T value) {
    return add_bytes(&value, sizeof value);
  }
  Fingerprinter& add(const Fingerprint& value) { return add_bytes(value.bytes.data(), value.bytes.size()); }
  Fingerprinter& add(std::string_view text) {
    add(std::uint64_t{text.size()});
    return add_bytes(text.data(), text.size());
  }
  Fingerprinter& add(const Vec2& value) { return add(value.x).add(value.y); }
  Fingerprinter& add(const Vec3& value) { return add(value.x).add(value.y).add(value.z); }
  Fingerprinter& add(const Box& value) { return add(value.min).add(value.max); }
  Fingerprinter& add(const Mat4& value) { return add_bytes(&value, sizeof value); }
  /// The number of values, and each. Of GLM's vectors and of plain values, whose arrays have no gaps.
  template <class T>
  Fingerprinter& add_list(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(std::uint64_t{values.size()});
    return add_bytes(values.data(), values.size() * sizeof(T));
  }

  /// Bytes as they are, without their number: what comes in pieces.
  Fingerprinter& add_bytes(const void* data, std::size_t size);

  /// Of all that was fed, which may go on.
  [[nodiscard]] Fingerprint fingerprint() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Of some bytes alone.
[[nodiscard]] Fingerprint fingerprint_of(std::string_view bytes);

}  // namespace standin
