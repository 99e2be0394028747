#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mocap/c3d_bytes.h"

namespace vultus::mocap {

/// One parameter of a C3D file's parameter section.
struct C3dParameter {
  std::string group, name;         ///< upper case; a group that is never defined is called "#" and its number
  int type = 0;                    ///< -1 characters, 1 bytes, 2 integers, 4 reals
  std::vector<int> dimensions;     ///< fastest first; empty for one value
  std::vector<std::uint8_t> data;  ///< as stored
};

/// The parameter section. Damaged records are passed over where the next one can be found without doubt, and every
/// such decision is recorded; names and sizes are never trusted beyond the section.
class C3dParameters {
 public:
  /// `section` are the bytes after the section's 4-byte head; `offset` is the place of its first byte in the file.
  static C3dParameters parse(std::span<const std::uint8_t> section, std::uint64_t offset, Decoder decoder,
                             std::vector<std::string>& decisions);

  const C3dParameter* find(std::string_view group, std::string_view name) const;
  /// Value `index` as a number whatever the stored type (characters are parsed); nothing when absent.
  std::optional<double> number(std::string_view group, std::string_view name, std::size_t index = 0) const;
  std::size_t count(std::string_view group, std::string_view name) const;  ///< values (strings for characters)
  /// Strings without trailing blanks and zeros; empty when absent or not of characters.
  std::vector<std::string> strings(std::string_view group, std::string_view name) const;
  /// The strings of NAME, NAME2, NAME3, … one after another.
  std::vector<std::string> long_strings(std::string_view group, std::string_view name) const;

  const std::vector<C3dParameter>& all() const { return parameters_; }

 private:
  Decoder decoder_;
  std::vector<C3dParameter> parameters_;
};

/// Builds a parameter section, Intel byte order.
class C3dParameterWriter {
 public:
  void group(int id, std::string_view name);
  void integers(int id, std::string_view name, const std::vector<int>& values);  ///< one value: no dimension
  void reals(int id, std::string_view name, const std::vector<float>& values, std::vector<int> dimensions = {});
  /// One dimension of characters for a single string.
  void text(int id, std::string_view name, std::string_view value);
  /// Splits over NAME, NAME2, … at 255 entries and at 32 kB.
  void texts(int id, std::string_view name, const std::vector<std::string>& values);

  /// The whole section in blocks of 512 bytes, head included. Throws `Error` above 255 blocks.
  std::vector<std::uint8_t> finish() const;

 private:
  void record(int id, std::string_view name, int type, const std::vector<int>& dimensions,
              std::span<const std::uint8_t> data);
  std::vector<std::uint8_t> bytes_;
};

}  // namespace vultus::mocap
