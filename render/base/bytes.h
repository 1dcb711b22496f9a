// Values as bytes and back, for files that only we read: fixed sizes, little endian, lists with their length first.
//
// What is written and read in the same order is one function over `Bytes`, which calls pass() for each value of a struct: a writer's takes
// it, a reader's sets it.
//
// A reader trusts nothing: it throws Failure(kFileBroken) where there are fewer bytes than a value or a list's length asks for.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "render/base/error.h"

namespace standin {

static_assert(std::endian::native == std::endian::little, "values are written as they lie in memory");

class ByteWriter {
 public:
  template <class T>
  void value(const T& value) {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <class T>
  void list(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    value(std::uint64_t{values.size()});
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
  void raw(std::string_view bytes) { bytes_.append(bytes); }
  template <class T>
  void pass(const T& one) {
    value(one);
  }
  template <class T>
  void pass(const std::vector<T>& values) {
    list(values);
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class ByteReader {
 public:
  /// `bytes` must outlive it.
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  template <class T>
  [[nodiscard]] T value() {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>);
    T value;
    std::memcpy(&value, raw(sizeof value).data(), sizeof value);
    return value;
  }
  template <class T>
  [[nodiscard]] std::vector<T> list() {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto count = value<std::uint64_t>();
    if (count > rest_.size() / sizeof(T)) throw too_short();
    std::vector<T> values(count);
    if (count > 0) std::memcpy(values.data(), raw(count * sizeof(T)).data(), count * sizeof(T));
    return values;
  }
  [[nodiscard]] std::string_view raw(std::size_t size) {
    if (size > rest_.size()) throw too_short();
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }
  template <class T>
  void pass(T& one) {
    one = value<T>();
  }
  void pass(bool& one) { one = value<std::uint8_t>() != 0; }
  template <class T>
  void pass(std::vector<T>& values) {
    values = list<T>();
  }
  [[nodiscard]] std::size_t size_left() const { return rest_.size(); }
  void require_end() const {
    if (!rest_.empty()) throw Failure(ErrorWord::kFileBroken, std::to_string(rest_.size()) + " bytes too many");
  }

 private:
  [[nodiscard]] Failure too_short() const {
    return {ErrorWord::kFileBroken, "bytes end early: only " + std::to_string(rest_.size()) + " are left"};
  }

  std::string_view rest_;
};

}  // namespace standin
