#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "core/array_io.h"
#include "core/error.h"
#include "core/files.h"

namespace vultus {
namespace {

class ArrayIo : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    file_ = std::filesystem::path(testing::TempDir()) / (std::string("vultus_array_") + info->name() + ".npy");
  }
  void TearDown() override { std::filesystem::remove(file_); }

  /// A version 1 file with the given header dictionary and data.
  void write(const std::string& dictionary, const std::string& data) {
    std::string bytes("\x93NUMPY\x01\x00", 8);
    bytes += static_cast<char>(dictionary.size() & 0xff);
    bytes += static_cast<char>(dictionary.size() >> 8);
    write_file(file_, bytes + dictionary + data);
  }
  std::string refusal() {
    try {
      read_npy(file_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
  template <class T>
  static std::string bytes_of(std::initializer_list<T> values) {
    std::string bytes(values.size() * sizeof(T), '\0');
    std::memcpy(bytes.data(), values.begin(), bytes.size());
    return bytes;
  }

  std::filesystem::path file_;
};

TEST_F(ArrayIo, WritesWhatNumPyWrites) {
  write_npy(file_, {{2, 3}, {1, 2, 3, 4, 5, 6}});
  const std::string bytes = read_file(file_);
  // numpy.save of the same array: 128 bytes of header ending in a newline, then the values.
  ASSERT_EQ(bytes.size(), 128u + 24u);
  EXPECT_EQ(bytes.substr(0, 10), std::string("\x93NUMPY\x01\x00\x76\x00", 10));
  EXPECT_EQ(bytes.substr(10, 60), "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), } ");
  EXPECT_EQ(bytes[127], '\n');
  EXPECT_EQ(bytes.substr(128), bytes_of<float>({1, 2, 3, 4, 5, 6}));
}

TEST_F(ArrayIo, ReadsBackEveryShape) {
  for (const std::vector<std::size_t>& shape : {std::vector<std::size_t>{}, {5}, {0, 4}, {2, 3}, {2, 1, 3, 2}}) {
    Array array = Array::zeros(shape);
    for (std::size_t i = 0; i < array.size(); ++i) array.values[i] = 0.5f * static_cast<float>(i) - 3;
    write_npy(file_, array);
    const Array read = read_npy(file_);
    EXPECT_EQ(read.shape, shape);
    EXPECT_EQ(read.values, array.values);
  }
}

TEST_F(ArrayIo, ConvertsDoublesAndIntegers) {
  write("{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }", bytes_of<double>({1.5, -2, 1e300}));
  EXPECT_EQ(read_npy(file_).values, (std::vector<float>{1.5f, -2, std::numeric_limits<float>::infinity()}));
  write("{\"shape\": (2,), \"fortran_order\": False, \"descr\": \"<i4\"}", bytes_of<std::int32_t>({-7, 9}));
  EXPECT_EQ(read_npy(file_).values, (std::vector<float>{-7, 9}));
}

TEST_F(ArrayIo, KeepsNan) {
  write_npy(file_, {{1}, {std::numeric_limits<float>::quiet_NaN()}});
  EXPECT_TRUE(std::isnan(read_npy(file_).values[0]));
}

TEST_F(ArrayIo, RefusesHostileFilesNamingThePlace) {
  const std::string four = bytes_of<float>({1, 2, 3, 4});
  const auto header = [](const std::string& type, const std::string& order, const std::string& shape) {
    return "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }";
  };
  const struct {
    std::string dictionary, says;
  } cases[] = {
      {header("<f4", "False", "(5,)"), "truncated"},
      {header("<f4", "False", "(3,)"), "more data"},
      {header("<f4", "False", "(18446744073709551615,)"), "absurdly large"},
      {header("<f4", "False", "(4294967296, 4294967296)"), "truncated"},  // the product wraps round to 0
      {header("<f4", "False", "(2305843009213693952, 8)"), "truncated"},
      {header("<f4", "True", "(4,)"), "Fortran"},
      {header("|O", "False", "(4,)"), "type '|O'"},
      {header(">f4", "False", "(4,)"), "type '>f4'"},
      {header("<f4", "maybe", "(4,)"), "True or False"},
      {header("<f4", "False", "(-4,)"), "non-negative"},
      {header("<f4", "False", "(4"), "expected"},
      {"{'descr': [('x', '<f4')], 'fortran_order': False, 'shape': (4,)}", "quoted string"},
      {"{'descr': '<f4', 'shape': (4,)}", "lacks"},
      {"{'descr': '<f4", "unterminated"},
      {"", "expected '{'"},
  };
  for (const auto& c : cases) {
    write(c.dictionary, four);
    EXPECT_NE(refusal().find(c.says), std::string::npos) << c.dictionary << "\n" << refusal();
    EXPECT_NE(refusal().find(file_.filename().string()), std::string::npos);
  }
  std::string nested = "(";
  for (int i = 0; i < 100; ++i) nested += "1,";
  write(header("<f4", "False", nested + ")"), four);
  EXPECT_NE(refusal().find("32 dimensions"), std::string::npos);
}

TEST_F(ArrayIo, RefusesEveryTruncation) {
  write_npy(file_, {{2, 2}, {1, 2, 3, 4}});
  const std::string whole = read_file(file_);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    write_file(file_, whole.substr(0, length));
    EXPECT_NE(refusal(), "accepted") << length << " bytes";
  }
  std::filesystem::remove(file_);
  EXPECT_NE(refusal(), "accepted");
}

}  // namespace
}  // namespace vultus
