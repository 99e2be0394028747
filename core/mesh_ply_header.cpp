#include "core/mesh_ply_header.h"

#include <algorithm>

#include "core/error.h"
#include "core/mesh_files.h"

namespace vultus::mesh_files {
namespace {

namespace fs = std::filesystem;

std::optional<PlyType> type_named(std::string_view name) {
  constexpr std::array<std::string_view, 16> names{"char",  "uchar",  "short",   "ushort", "int",   "uint",
                                                   "float", "double", "int8",    "uint8",  "int16", "uint16",
                                                   "int32", "uint32", "float32", "float64"};
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<PlyType>((found - names.begin()) % 8);
}

class HeaderReader {
 public:
  HeaderReader(const fs::path& file, std::string_view content) : file_(file), text_(content) {}

  PlyHeader read() {
    text_.next_line();
    if (text_.word() != "ply") fail("a PLY file starts with \"ply\"");
    bool has_format = false;
    for (;;) {
      if (!text_.next_line()) fail("the header has no end_header");
      ++header_.lines;
      const std::string_view keyword = text_.word();
      if (keyword == "end_header") break;
      if (keyword == "format")
        has_format = read_format();
      else if (keyword == "element")
        read_element();
      else if (keyword == "property")
        read_property();
      else if (keyword == "comment" && text_.word() == "TextureFile")
        header_.texture = text_.rest_of_line();
    }
    if (!has_format) fail("the header names no format");
    ++header_.lines;
    header_.body = text_.rest_of_file();
    return header_;
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const { throw InputError(file_, text_.place(), problem); }

  bool read_format() {
    const std::string_view name = text_.word();
    if (name == "ascii")
      header_.format = PlyFormat::ascii;
    else if (name == "binary_little_endian")
      header_.format = PlyFormat::little;
    else if (name == "binary_big_endian")
      header_.format = PlyFormat::big;
    else
      fail("format \"" + std::string(name.substr(0, 40)) + "\" is not ascii or binary_{little,big}_endian");
    return true;
  }

  void read_element() {
    PlyElement element;
    element.name = text_.word();
    if (element.name.empty() || !parse(text_.word(), element.count)) fail("an element needs a name and a count");
    header_.elements.push_back(std::move(element));
  }

  PlyType read_type() {
    const std::string_view name = text_.word();
    const auto type = type_named(name);
    if (!type) fail("\"" + std::string(name.substr(0, 40)) + "\" is not a PLY type");
    return *type;
  }

  void read_property() {
    if (header_.elements.empty()) fail("a property stands before the first element");
    PlyProperty property;
    const TextCursor before = text_;
    if (text_.word() == "list") {
      property.count_type = read_type();
      if (*property.count_type >= PlyType::float32) fail("a list's count cannot be a float");
    } else {
      text_ = before;
    }
    property.type = read_type();
    property.name = text_.word();
    if (property.name.empty()) fail("a property needs a name");
    header_.elements.back().properties.push_back(std::move(property));
  }

  fs::path file_;
  TextCursor text_;
  PlyHeader header_;
};

}  // namespace

PlyHeader read_ply_header(const fs::path& file, std::string_view content) { return HeaderReader(file, content).read(); }

}  // namespace vultus::mesh_files
