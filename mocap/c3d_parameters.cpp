#include "mocap/c3d_parameters.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <map>

#include "core/error.h"

namespace vultus::mocap {

namespace {

using Bytes = std::span<const std::uint8_t>;

std::string upper(Bytes name) {
  std::string text(name.begin(), name.end());
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

std::string trimmed(Bytes text) {
  std::size_t end = text.size();
  while (end > 0 && (text[end - 1] == ' ' || text[end - 1] == 0)) --end;
  std::string result(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end));
  result.erase(std::remove(result.begin(), result.end(), '\0'), result.end());
  return result.substr(std::min(result.find_first_not_of(' '), result.size()));
}

std::size_t name_length(Bytes section, std::size_t at) {
  return static_cast<std::size_t>(std::abs(static_cast<std::int8_t>(section[at])));  // negative: a locked parameter
}

/// True where a record starts: a printable name, a group and room for the offset. The end of the section (a zero name
/// length, or nothing left) counts too.
bool plausible(Bytes section, std::size_t at) {
  if (at >= section.size() || section[at] == 0) return at <= section.size();
  const std::size_t length = name_length(section, at);
  if (at + 4 + length > section.size() || section[at + 1] == 0) return false;
  const Bytes name = section.subspan(at + 2, length);
  return std::all_of(name.begin(), name.end(), [](std::uint8_t c) { return c > 32 && c < 127; });
}

/// Data and description of the parameter record whose type byte is at `at`; `end` is set after them. Nothing when they
/// leave the section or the type is none of C3D's.
std::optional<C3dParameter> parameter_at(Bytes section, std::size_t at, std::size_t& end) {
  if (at + 2 > section.size()) return {};
  C3dParameter parameter;
  parameter.type = static_cast<std::int8_t>(section[at]);
  const std::size_t dimension_count = section[at + 1];
  const bool known = parameter.type == -1 || parameter.type == 1 || parameter.type == 2 || parameter.type == 4;
  if (!known || dimension_count > 7 || at + 2 + dimension_count > section.size()) return {};
  std::size_t bytes = static_cast<std::size_t>(std::abs(parameter.type));
  for (std::size_t d = 0; d < dimension_count; ++d) {
    parameter.dimensions.push_back(section[at + 2 + d]);
    bytes *= section[at + 2 + d];
    if (bytes > section.size()) return {};
  }
  const std::size_t data = at + 2 + dimension_count;
  if (data + bytes > section.size()) return {};
  parameter.data.assign(section.begin() + static_cast<std::ptrdiff_t>(data),
                        section.begin() + static_cast<std::ptrdiff_t>(data + bytes));
  end = data + bytes;
  if (end < section.size()) end += 1 + std::size_t{section[end]};
  return parameter;
}

}  // namespace

C3dParameters C3dParameters::parse(Bytes section, std::uint64_t offset, Decoder decoder,
                                   std::vector<std::string>& decisions) {
  C3dParameters result;
  result.decoder_ = decoder;
  std::map<int, std::string> groups;
  std::vector<int> group_of;
  const auto place = [&](std::size_t at) { return "byte " + std::to_string(offset + at); };
  std::size_t at = 0;
  while (at + 4 <= section.size() && section[at] != 0) {
    if (!plausible(section, at)) {
      decisions.push_back("parameters: what follows " + place(at) + " is not a parameter and was passed over");
      break;
    }
    const std::size_t length = name_length(section, at);
    const int id = static_cast<std::int8_t>(section[at + 1]);
    const std::string name = upper(section.subspan(at + 2, length));
    const std::size_t link = at + 2 + length;
    const std::size_t step = decoder.word(section.data() + link);
    std::size_t end = link + 2;
    if (id < 0) {
      groups.emplace(-id, name);
      if (end < section.size()) end += 1 + std::size_t{section[end]};
    } else if (auto parameter = parameter_at(section, link + 2, end)) {
      parameter->name = name;
      result.parameters_.push_back(std::move(*parameter));
      group_of.push_back(id);
    } else {
      decisions.push_back("parameters: " + name + " at " + place(at) + " is damaged and was passed over");
    }
    if (step == 0) break;
    const bool trust_link = step > 1 && plausible(section, link + step);
    if (!trust_link && end > link + 2 && plausible(section, end)) {
      if (end < section.size() && section[end] != 0) {
        decisions.push_back("parameters: " + name + " at " + place(at) +
                            " points outside; the next one was found by size");
      }
      at = end;
    } else if (trust_link) {
      at = link + step;
    } else {
      decisions.push_back("parameters: what follows " + name + " at " + place(at) + " could not be found");
      break;
    }
  }
  for (std::size_t i = 0; i < group_of.size(); ++i) {
    const auto found = groups.find(group_of[i]);
    result.parameters_[i].group = found == groups.end() ? "#" + std::to_string(group_of[i]) : found->second;
  }
  return result;
}

const C3dParameter* C3dParameters::find(std::string_view group, std::string_view name) const {
  for (const C3dParameter& parameter : parameters_) {
    if (parameter.group == group && parameter.name == name) return &parameter;
  }
  return nullptr;
}

std::size_t C3dParameters::count(std::string_view group, std::string_view name) const {
  const C3dParameter* parameter = find(group, name);
  if (parameter == nullptr) return 0;
  const std::size_t values = parameter->data.size() / static_cast<std::size_t>(std::abs(parameter->type));
  if (parameter->type != -1) return values;
  const std::size_t width = parameter->dimensions.empty() ? 1 : static_cast<std::size_t>(parameter->dimensions[0]);
  return parameter->dimensions.size() < 2 ? 1 : (width == 0 ? 0 : values / width);
}

std::optional<double> C3dParameters::number(std::string_view group, std::string_view name, std::size_t index) const {
  const C3dParameter* parameter = find(group, name);
  if (parameter == nullptr || index >= count(group, name)) return {};
  const std::uint8_t* data = parameter->data.data();
  switch (parameter->type) {
    case 1:
      return data[index];
    case 2:
      return decoder_.integer(data + 2 * index);
    case 4:
      return decoder_.real(data + 4 * index);
    default:
      break;
  }
  const std::string text = strings(group, name)[index];
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return end == text.c_str() ? std::nullopt : std::optional<double>(value);
}

std::vector<std::string> C3dParameters::strings(std::string_view group, std::string_view name) const {
  const C3dParameter* parameter = find(group, name);
  if (parameter == nullptr || parameter->type != -1) return {};
  const std::size_t n = count(group, name);
  const std::size_t width = n == 0 ? 0 : parameter->data.size() / n;
  std::vector<std::string> result;
  for (std::size_t i = 0; i < n; ++i) result.push_back(trimmed(Bytes(parameter->data).subspan(i * width, width)));
  return result;
}

std::vector<std::string> C3dParameters::long_strings(std::string_view group, std::string_view name) const {
  std::vector<std::string> result = strings(group, name);
  for (int i = 2; i < 1000; ++i) {
    const std::vector<std::string> more = strings(group, std::string(name) + std::to_string(i));
    if (more.empty()) break;
    result.insert(result.end(), more.begin(), more.end());
  }
  return result;
}

void C3dParameterWriter::group(int id, std::string_view name) {
  bytes_.push_back(static_cast<std::uint8_t>(name.size()));
  bytes_.push_back(static_cast<std::uint8_t>(-id));
  bytes_.insert(bytes_.end(), name.begin(), name.end());
  const std::uint8_t tail[] = {3, 0, 0};  // offset to the next record, no description
  bytes_.insert(bytes_.end(), std::begin(tail), std::end(tail));
}

void C3dParameterWriter::record(int id, std::string_view name, int type, const std::vector<int>& dimensions,
                                Bytes data) {
  const std::size_t step = 2 + 2 + dimensions.size() + data.size() + 1;
  bytes_.push_back(static_cast<std::uint8_t>(name.size()));
  bytes_.push_back(static_cast<std::uint8_t>(id));
  bytes_.insert(bytes_.end(), name.begin(), name.end());
  bytes_.push_back(static_cast<std::uint8_t>(step & 0xff));
  bytes_.push_back(static_cast<std::uint8_t>(step >> 8));
  bytes_.push_back(static_cast<std::uint8_t>(type));
  bytes_.push_back(static_cast<std::uint8_t>(dimensions.size()));
  for (const int d : dimensions) bytes_.push_back(static_cast<std::uint8_t>(d));
  bytes_.insert(bytes_.end(), data.begin(), data.end());
  bytes_.push_back(0);
}

void C3dParameterWriter::integers(int id, std::string_view name, const std::vector<int>& values) {
  std::vector<std::uint8_t> data;
  for (const int value : values) {
    data.push_back(static_cast<std::uint8_t>(value & 0xff));
    data.push_back(static_cast<std::uint8_t>((value >> 8) & 0xff));
  }
  record(id, name, 2, values.size() == 1 ? std::vector<int>{} : std::vector<int>{static_cast<int>(values.size())},
         data);
}

void C3dParameterWriter::reals(int id, std::string_view name, const std::vector<float>& values,
                               std::vector<int> dimensions) {
  std::vector<std::uint8_t> data(4 * values.size());
  std::memcpy(data.data(), values.data(), data.size());  // Intel order, as this machine's
  record(id, name, 4, dimensions, data);
}

void C3dParameterWriter::text(int id, std::string_view name, std::string_view value) {
  record(id, name, -1, {static_cast<int>(value.size())},
         Bytes(reinterpret_cast<const std::uint8_t*>(value.data()), value.size()));
}

void C3dParameterWriter::texts(int id, std::string_view name, const std::vector<std::string>& values) {
  std::size_t width = 1;
  for (const std::string& value : values) width = std::max(width, value.size());
  if (width > 255) throw Error("C3D cannot hold a name of " + std::to_string(width) + " characters (255 at most)");
  const std::size_t batch = std::min<std::size_t>(255, 32000 / width);
  for (std::size_t first = 0, part = 1; first < values.size() || part == 1; first += batch, ++part) {
    const std::size_t n = std::min(batch, values.size() - first);
    std::vector<std::uint8_t> data(n * width, ' ');
    for (std::size_t i = 0; i < n; ++i) {
      std::copy(values[first + i].begin(), values[first + i].end(),
                data.begin() + static_cast<std::ptrdiff_t>(i * width));
    }
    const std::string suffix = part == 1 ? "" : std::to_string(part);
    record(id, std::string(name) + suffix, -1, {static_cast<int>(width), static_cast<int>(n)}, data);
  }
}

std::vector<std::uint8_t> C3dParameterWriter::finish() const {
  const std::size_t blocks = (4 + bytes_.size() + 2 + 511) / 512;
  if (blocks > 255) throw Error("the marker names do not fit the parameter section of a C3D file (127 kB)");
  std::vector<std::uint8_t> section(blocks * 512, 0);
  section[0] = 1;
  section[1] = 80;
  section[2] = static_cast<std::uint8_t>(blocks);
  section[3] = static_cast<std::uint8_t>(Processor::intel);
  std::copy(bytes_.begin(), bytes_.end(), section.begin() + 4);
  return section;
}

}  // namespace vultus::mocap
