#include "core/array_io.h"

#include <bit>
#include <cctype>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "core/error.h"
#include "core/files.h"

namespace vultus {
namespace {

static_assert(std::endian::native == std::endian::little, ".npy data is copied as it lies in the file");

constexpr std::string_view magic("\x93NUMPY", 6);
constexpr std::size_t max_dimensions = 32;  // NumPy's own limit

struct Header {
  std::string type;
  bool fortran_order = false;
  std::vector<std::size_t> shape;
  std::size_t data_offset = 0;
};

/// Reads the Python dictionary literal of a .npy header.
class HeaderParser {
 public:
  HeaderParser(const std::filesystem::path& file, std::string_view text, std::size_t offset)
      : file_(file), text_(text), offset_(offset) {}

  Header parse() {
    Header header;
    bool has_type = false, has_order = false, has_shape = false;
    expect('{');
    while (!accept('}')) {
      const std::string key = quoted();
      expect(':');
      if (key == "descr") {
        header.type = quoted();
        has_type = true;
      } else if (key == "fortran_order") {
        header.fortran_order = boolean();
        has_order = true;
      } else if (key == "shape") {
        header.shape = tuple();
        has_shape = true;
      } else {
        fail("unknown header key '" + key + "'");
      }
      if (!accept(',') && peek() != '}') fail("expected ',' or '}'");
    }
    if (!has_type || !has_order || !has_shape) fail("header lacks descr, fortran_order or shape");
    return header;
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(file_, "byte " + std::to_string(offset_ + at_), problem);
  }
  char peek() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool accept(char c) {
    if (peek() != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!accept(c)) fail(std::string("expected '") + c + "'");
  }
  std::string quoted() {
    const char quote = peek();
    if (quote != '\'' && quote != '"') fail("expected a quoted string (structured types are not supported)");
    const std::size_t end = text_.find(quote, ++at_);
    if (end == std::string_view::npos) fail("unterminated string");
    std::string result(text_.substr(at_, end - at_));
    at_ = end + 1;
    return result;
  }
  bool boolean() {
    peek();
    for (const auto& [word, value] : {std::pair{std::string_view("True"), true}, {std::string_view("False"), false}}) {
      if (text_.substr(at_).starts_with(word)) {
        at_ += word.size();
        return value;
      }
    }
    fail("expected True or False");
  }
  std::size_t integer() {
    if (!std::isdigit(static_cast<unsigned char>(peek()))) fail("expected a non-negative integer");
    std::size_t value = 0;
    for (; at_ < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at_])); ++at_) {
      if (value > std::numeric_limits<std::size_t>::max() / 10 - 1) fail("dimension is absurdly large");
      value = 10 * value + static_cast<std::size_t>(text_[at_] - '0');
    }
    return value;
  }
  std::vector<std::size_t> tuple() {
    std::vector<std::size_t> shape;
    expect('(');
    while (!accept(')')) {
      if (shape.size() == max_dimensions) fail("more than 32 dimensions");
      shape.push_back(integer());
      if (!accept(',') && peek() != ')') fail("expected ',' or ')'");
    }
    return shape;
  }

  const std::filesystem::path& file_;
  std::string_view text_;
  std::size_t offset_, at_ = 0;
};

Header read_header(const std::filesystem::path& file, std::string_view bytes) {
  if (bytes.size() < 10 || bytes.substr(0, 6) != magic)
    throw InputError(file, "byte 0", "not a NumPy .npy array (no \\x93NUMPY at its start)");
  const int version = static_cast<unsigned char>(bytes[6]);
  if (version < 1 || version > 3)
    throw InputError(file, "byte 6", ".npy version " + std::to_string(version) + " is not supported; 1, 2 and 3 are");
  const std::size_t length_bytes = version == 1 ? 2 : 4;
  if (bytes.size() < 8 + length_bytes) throw InputError(file, "byte 8", "truncated header");
  std::size_t length = 0;
  for (std::size_t i = 0; i < length_bytes; ++i)
    length |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[8 + i])) << (8 * i);
  const std::size_t start = 8 + length_bytes;
  if (length > bytes.size() - start) throw InputError(file, "byte 8", "header is longer than the file");
  Header header = HeaderParser(file, bytes.substr(start, length), start).parse();
  header.data_offset = start + length;
  return header;
}

/// Product of the dimensions, or nothing when `limit` values are exceeded.
std::optional<std::size_t> count_values(const std::vector<std::size_t>& shape, std::size_t limit) {
  for (const std::size_t n : shape)
    if (n == 0) return 0;
  std::size_t count = 1;
  for (const std::size_t n : shape) {
    if (n > limit / count) return std::nullopt;
    count *= n;
  }
  return count;
}

template <class T>
void copy_values(std::string_view data, std::vector<float>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    T value;
    std::memcpy(&value, data.data() + i * sizeof(T), sizeof(T));
    values[i] = static_cast<float>(value);
  }
}

}  // namespace

Array Array::zeros(std::vector<std::size_t> shape) {
  std::size_t count = 1;
  for (const std::size_t n : shape) count *= n;
  return {std::move(shape), std::vector<float>(count, 0.0f)};
}

Array read_npy(const std::filesystem::path& file) {
  const std::string bytes = read_file(file);
  Header header = read_header(file, bytes);
  if (header.type != "<f4" && header.type != "<f8" && header.type != "<i4")
    throw InputError(file, "header", "type '" + header.type + "' is not supported; '<f4', '<f8' and '<i4' are");
  if (header.fortran_order)
    throw InputError(file, "header", "Fortran order is not supported; save with numpy.ascontiguousarray");

  const std::string_view data = std::string_view(bytes).substr(header.data_offset);
  const std::size_t value_bytes = header.type == "<f8" ? 8 : 4;
  const auto count = count_values(header.shape, data.size() / value_bytes);
  if (!count)
    throw InputError(file, "byte " + std::to_string(bytes.size()),
                     "truncated: the shape needs more data than is there");
  if (*count * value_bytes != data.size())
    throw InputError(file, "byte " + std::to_string(header.data_offset + *count * value_bytes),
                     "more data than the shape names");

  Array array{std::move(header.shape), std::vector<float>(*count)};
  if (header.type == "<f4") copy_values<float>(data, array.values);
  if (header.type == "<f8") copy_values<double>(data, array.values);
  if (header.type == "<i4") copy_values<std::int32_t>(data, array.values);
  return array;
}

void write_npy(const std::filesystem::path& file, const Array& array) {
  std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (";
  for (const std::size_t n : array.shape) header += std::to_string(n) + ", ";
  if (array.shape.size() > 1) header.resize(header.size() - 2);
  if (array.shape.size() == 1) header.pop_back();
  header += "), }";
  // NumPy aligns the data to 64 bytes and ends the header with a newline.
  const std::size_t preamble = magic.size() + 4;
  header.append(63 - (preamble + header.size()) % 64, ' ');
  header += '\n';

  std::string bytes(magic);
  bytes += '\x01';
  bytes += '\x00';
  bytes += static_cast<char>(header.size() & 0xff);
  bytes += static_cast<char>(header.size() >> 8);
  bytes += header;
  bytes.append(reinterpret_cast<const char*>(array.values.data()), array.values.size() * sizeof(float));
  write_file(file, bytes);
}

}  // namespace vultus
