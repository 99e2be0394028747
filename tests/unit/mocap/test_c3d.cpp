#include <gtest/gtest.h>

#include "core/error.h"
#include "mocap/c3d.h"
#include "tests/unit/mocap/takes.h"

namespace vultus::mocap {
namespace {

class C3d : public InFolder {};

void expect_same(const Take& a, const Take& b) {
  ASSERT_EQ(a.labels, b.labels);
  ASSERT_EQ(a.present, b.present);
  EXPECT_DOUBLE_EQ(a.rate_hz, b.rate_hz);
  for (std::size_t i = 0; i < a.present.size(); ++i) {
    if (a.present[i] == 0) continue;
    for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(a.positions[3 * i + c], b.positions[3 * i + c]) << i;
  }
}

TEST_F(C3d, WrittenTakeReadsBackBitForBit) {
  Take take = random_take(50, 9, 1);
  take.residual_step = 0.05F;
  take.residuals.assign(take.present.size(), 0.0F);
  take.cameras.assign(take.present.size(), 0);
  for (std::size_t i = 0; i < take.present.size(); ++i) {
    if (take.present[i] == 0) continue;
    take.residuals[i] = static_cast<float>(i % 200) * take.residual_step;
    take.cameras[i] = static_cast<std::uint8_t>(i % 128);
  }
  take.first_frame = 37;
  take.events = {{"clap", 0.25}, {"neutral start", 61.5}};
  write_c3d(folder / "a.c3d", take);
  const Take read = read_c3d(folder / "a.c3d");
  expect_same(take, read);
  EXPECT_EQ(take.residuals, read.residuals);
  EXPECT_EQ(take.cameras, read.cameras);
  EXPECT_EQ(read.first_frame, 37);
  ASSERT_EQ(read.events.size(), 2U);
  EXPECT_EQ(read.events[1].label, "neutral start");
  EXPECT_NEAR(read.events[1].time_s, 61.5, 1e-5);  // stored in single precision
}

TEST_F(C3d, ManyLabelsAndLongNames) {
  Take take = random_take(3, 700, 2);
  take.labels[3] = std::string(60, 'q');
  write_c3d(folder / "many.c3d", take);
  expect_same(take, read_c3d(folder / "many.c3d"));
}

TEST_F(C3d, MoreFramesThanAWordCounts) {
  Take take = Take::empty("long", 240.0, {"a", "b"}, 70001);
  for (int f = 0; f < take.frames(); f += 7) take.set(f, f % 2, {f * 0.01, 1.0, 2.0});
  write_c3d(folder / "long.c3d", take);
  expect_same(take, read_c3d(folder / "long.c3d"));
}

/// A C3D of one marker and two frames (the second invalid), built byte by byte from the format's description.
std::string tiny(char processor, bool real) {
  const bool big = processor == 86;
  std::string bytes(4 * 512, '\0');
  const auto word = [&](std::size_t at, int v) {
    bytes[at + (big ? 1 : 0)] = static_cast<char>(v & 0xff);
    bytes[at + (big ? 0 : 1)] = static_cast<char>((v >> 8) & 0xff);
  };
  const auto number = [&](std::size_t at, float v) {
    const auto bits = std::bit_cast<std::uint32_t>(processor == 85 ? v * 4.0F : v);
    const int high = static_cast<int>(bits >> 16), low = static_cast<int>(bits & 0xffff);
    word(at, processor == 84 ? low : high);
    word(at + 2, processor == 84 ? high : low);
  };
  bytes[0] = 2;
  bytes[1] = 80;
  word(2, 1);
  word(6, 1);
  word(8, 2);
  number(12, real ? -0.5F : 0.5F);
  word(16, 4);
  number(20, 100.0F);
  bytes[512 + 2] = 2;
  bytes[512 + 3] = processor;
  std::size_t at = 516;
  const auto put = [&](const std::string& text) {
    bytes.replace(at, text.size(), text);
    at += text.size();
  };
  const auto start = [&](const std::string& name, int id, int step) {
    put(std::string(1, static_cast<char>(name.size())) + static_cast<char>(id) + name);
    word(at, step);
    at += 2;
  };
  start("POINT", -1, 3);
  put(std::string(1, '\0'));
  start("UNITS", 1, 8);
  put(std::string("\xff\x01\x02") + "cm" + '\0');
  start("LABELS", 1, 11);
  put(std::string("\xff\x02\x04\x01") + "chin" + '\0');
  start("X_SCREEN", 1, 8);
  put(std::string("\xff\x01\x02") + "+Y" + '\0');
  start("Y_SCREEN", 1, 8);
  put(std::string("\xff\x01\x02") + "+Z" + '\0');
  const std::size_t data = 3 * 512, size = real ? 4 : 2;
  const float values[] = {3.0F, -2.0F, 7.5F, 5 * 256 + 3.0F, 1.0F, 1.0F, 1.0F, -1.0F};
  for (std::size_t i = 0; i < 8; ++i) {
    if (real)
      number(data + size * i, values[i]);
    else
      word(data + size * i, static_cast<int>(i % 4 < 3 ? values[i] / 0.5F : values[i]));
  }
  return bytes;
}

TEST_F(C3d, EveryProcessorAndNumberTypeByHand) {
  for (const char processor : {char(84), char(85), char(86)}) {
    for (const bool real : {false, true}) {
      const Take take = read_c3d(write("tiny.c3d", tiny(processor, real)));
      ASSERT_EQ(take.labels, std::vector<std::string>{"chin"}) << int(processor) << real;
      ASSERT_EQ(take.frames(), 2);
      EXPECT_DOUBLE_EQ(take.rate_hz, 100.0);
      ASSERT_TRUE(take.has(0, 0));
      EXPECT_FALSE(take.has(1, 0));
      // Screen right is the file's y, up its z; so toward the viewer is x. Centimetres become millimetres.
      EXPECT_EQ(take.at(0, 0), Eigen::Vector3d(-20.0, 75.0, 30.0));
      EXPECT_FLOAT_EQ(take.residuals[0], 3 * 0.5F * 10);
      EXPECT_EQ(take.cameras[0], 5);
    }
  }
}

TEST_F(C3d, OptionsOverrideTheFile) {
  ReadOptions options;
  options.unit = "mm";
  options.up_axis = "-x";
  EXPECT_EQ(read_c3d(write("tiny.c3d", tiny(84, true)), options).at(0, 0), Eigen::Vector3d(-2.0, -3.0, 7.5));
  options.up_axis = "upwards";
  EXPECT_THROW(read_c3d(folder / "tiny.c3d", options), InputError);
}

TEST_F(C3d, HundredsOfEventsComeBack) {
  Take take = random_take(3, 2, 4);
  for (int i = 0; i < 300; ++i) take.events.push_back({"e" + std::to_string(i), 0.5 * i});
  write_c3d(folder / "events.c3d", take);
  const Take read = read_c3d(folder / "events.c3d");
  ASSERT_EQ(read.events.size(), 300U);
  EXPECT_EQ(read.events[299].label, "e299");
  EXPECT_NEAR(read.events[299].time_s, 149.5, 1e-5);  // stored in single precision
}

bool says(const Take& take, const std::string& words) {
  return std::any_of(take.decisions.begin(), take.decisions.end(),
                     [&](const std::string& line) { return line.find(words) != std::string::npos; });
}

TEST_F(C3d, RepairsWhatIsUnambiguousAndSaysSo) {
  const Take sound = read_c3d(write("sound.c3d", tiny(84, true)));
  const auto repaired = [&](std::string bytes, const std::string& words) {
    const Take take = read_c3d(write("odd.c3d", bytes));
    expect_same(take, sound);
    EXPECT_TRUE(says(take, words)) << words << ": " << (take.decisions.empty() ? "" : take.decisions[0]);
    EXPECT_FALSE(says(sound, words));
  };
  std::string bytes = tiny(84, true);
  bytes[0] = 0;  // the parameter section nowhere, or where none is
  repaired(bytes, "found in block 2");
  bytes[0] = 4;
  repaired(bytes, "found in block 2");
  bytes = tiny(84, true);
  bytes[514] = 99;  // blocks of parameters
  repaired(bytes, "end where the samples start");
  bytes = tiny(84, true);
  bytes[15] = static_cast<char>(bytes[15] & 0x7f);  // a positive scale over real samples
  bytes.resize(bytes.size() + 512);
  // Two frames of one marker fill a block either way, so nothing says that they are real: read as stated.
  EXPECT_NE(read_c3d(write("odd.c3d", bytes)).positions, sound.positions);
}

TEST_F(C3d, RealSamplesUnderAnIntegerScale) {
  Take take = random_take(200, 5, 6);
  for (std::size_t i = 0; i < take.present.size(); ++i) take.present[i] = 1;
  write_c3d(folder / "real.c3d", take);
  std::string bytes = bytes_of(folder / "real.c3d");
  bytes[15] = static_cast<char>(bytes[15] & 0x7f);  // the header's sign
  const std::size_t scale = bytes.find("SCALE");
  bytes[scale + 12] = static_cast<char>(bytes[scale + 12] & 0x7f);  // and the parameter's: 5 letters, 2+1+1 bytes, 4
  const Take read = read_c3d(write("positive.c3d", bytes));
  expect_same(read, read_c3d(folder / "real.c3d"));
  EXPECT_TRUE(says(read, "the only one that fills the file"));
}

TEST_F(C3d, FramesThatRanOverSixteenBits) {
  Take take = Take::empty("long", 240.0, {"a", "b"}, 70001);
  for (int f = 0; f < take.frames(); f += 7) take.set(f, f % 2, {f * 0.01, 1.0, 2.0});
  write_c3d(folder / "long.c3d", take);
  std::string bytes = bytes_of(folder / "long.c3d");
  for (const char* name : {"ACTUAL_START_FIELD", "ACTUAL_END_FIELD", "LONG_FRAMES", "FRAMES"}) {
    for (std::size_t at = bytes.find(name); at < 4096; at = bytes.find(name)) bytes[at] = 'Q';
  }
  expect_same(read_c3d(write("stopped.c3d", bytes)), take);  // the header stops at 65,535
  bytes[8] = 70001 & 0xff;
  bytes[9] = (70001 >> 8) & 0xff;
  const Take wrapped = read_c3d(write("wrapped.c3d", bytes));
  expect_same(wrapped, take);
  EXPECT_TRUE(says(wrapped, "the only one that fills the file"));
}

TEST_F(C3d, EveryTruncationIsRefusedOrRead) {
  const std::string whole = tiny(84, true);
  const std::size_t samples_end = 3 * 512 + 32;
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    const auto file = write("cut.c3d", whole.substr(0, size));
    if (size < samples_end) {
      EXPECT_THROW(read_c3d(file), InputError) << size;
    } else {
      EXPECT_EQ(read_c3d(file).frames(), 2) << size;
    }
  }
}

TEST_F(C3d, TruncationNamesTheByte) {
  try {
    read_c3d(write("cut.c3d", tiny(84, true).substr(0, 1550)));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("byte 1550"), std::string::npos) << error.what();
  }
}

TEST_F(C3d, DamagedBytesNeverCrash) {
  Random random(5);
  for (const char processor : {char(84), char(85), char(86)}) {
    for (int round = 0; round < 1000; ++round) {
      std::string bytes = tiny(processor, round % 2 == 0);
      const int flips = 1 + random.below(6);
      for (int i = 0; i < flips; ++i) {
        bytes[static_cast<std::size_t>(random.below(640))] = static_cast<char>(random.below(256));
      }
      try {
        const Take take = read_c3d(write("bad.c3d", bytes));
        // What is read never exceeds what the file can hold: 8 bytes a sample at the least.
        ASSERT_LE(take.present.size(), bytes.size() / 8);
        for (std::size_t i = 0; i < take.present.size(); ++i) {
          ASSERT_TRUE(take.present[i] == 0 || std::isfinite(take.positions[3 * i]));
        }
      } catch (const InputError&) {
      }
    }
  }
}

TEST_F(C3d, RefusesWhatIsNoC3d) {
  EXPECT_THROW(read_c3d(folder / "none.c3d"), InputError);
  EXPECT_THROW(read_c3d(folder), InputError);
  EXPECT_THROW(read_c3d(write("empty.c3d", "")), InputError);
  std::string bytes = tiny(84, true);
  bytes[515] = 99;
  EXPECT_THROW(read_c3d(write("processor.c3d", bytes)), InputError);
  EXPECT_THROW(write_c3d(folder / "empty.c3d", Take{}), OutputError);
}

TEST_F(C3d, EveryRealFileReadsAndSurvivesWriting) {
  const auto data = real_data() / "c3d-samples/C3DSamples/c3d.org";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "VULTUS_DATA has no c3d-samples";
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(data)) {
    std::string extension = entry.path().extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    if (extension != ".c3d") continue;
    ++files;
    const Take take = read_c3d(entry.path());
    write_c3d(folder / "again.c3d", take);
    const Take again = read_c3d(folder / "again.c3d");
    SCOPED_TRACE(entry.path());
    expect_same(take, again);  // bit for bit, what is missing included
    EXPECT_EQ(take.cameras, again.cameras);
    EXPECT_EQ(take.events.size(), again.events.size());
    for (std::size_t i = 0; i < take.residuals.size(); ++i) {
      ASSERT_NEAR(take.residuals[i], again.residuals[i], 0.51F * take.residual_step) << i;  // whole steps are kept
    }
  }
  EXPECT_EQ(files, 21);
}

TEST(C3dReal, EquivalentFilesAgree) {
  const auto data = real_data() / "c3d-samples/C3DSamples/c3d.org";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "VULTUS_DATA has no c3d-samples";
  const std::vector<std::vector<std::string>> groups = {
      {"sample01/Eb015pr.c3d", "sample01/Eb015sr.c3d", "sample01/Eb015vr.c3d", "sample01/Eb015pi.c3d",
       "sample01/Eb015si.c3d", "sample01/Eb015vi.c3d"},
      {"sample02/pc_real.c3d", "sample02/Dec_real.c3d", "sample02/sgi_real.c3d", "sample02/pc_int.c3d",
       "sample02/DEC_INT.C3D", "sample02/sgi_int.c3d"}};
  for (const auto& group : groups) {
    const Take reference = read_c3d(data / group[0]);
    for (const std::string& name : group) {
      const Take take = read_c3d(data / name);
      ASSERT_EQ(take.labels, reference.labels) << name;
      ASSERT_EQ(take.present, reference.present) << name;
      // DEC_INT itself holds another number in 96 of its camera masks, each larger by exactly one (0x39 for 0x3a):
      // nothing in the file tells which, so what it says is kept.
      int differing = 0;
      for (std::size_t i = 0; i < take.cameras.size(); ++i) {
        if (take.cameras[i] == reference.cameras[i]) continue;
        ++differing;
        ASSERT_EQ(take.cameras[i], reference.cameras[i] + 1) << name << " " << i;
      }
      EXPECT_EQ(differing, name == "sample02/DEC_INT.C3D" ? 96 : 0) << name;
      const float step = reference.residual_step;  // the files' own quantization
      for (std::size_t i = 0; i < take.present.size(); ++i) {
        if (take.present[i] == 0) continue;
        ASSERT_LE(std::abs(take.residuals[i] - reference.residuals[i]), step * 1.001F) << name;
        for (std::size_t c = 0; c < 3; ++c) {
          ASSERT_LE(std::abs(take.positions[3 * i + c] - reference.positions[3 * i + c]), step * 1.001F) << name;
        }
      }
    }
  }
}

TEST(C3dReal, OddButCommonFilesRead) {
  const auto data = real_data() / "c3d-samples/C3DSamples/c3d.org";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "VULTUS_DATA has no c3d-samples";
  const auto expect = [&](const std::string& name, int frames, int markers) {
    const Take take = read_c3d(data / name);
    EXPECT_EQ(take.frames(), frames) << name;
    EXPECT_EQ(take.markers(), markers) << name;
    EXPECT_FALSE(take.decisions.empty()) << name;
    int extent = 0, seen = 0;  // a person in a room, whatever the file's units
    for (std::size_t i = 0; i < take.present.size(); ++i) {
      if (take.present[i] == 0) continue;
      ++seen;
      extent += std::abs(take.positions[3 * i + 1]) < 4000.0F;
    }
    EXPECT_GT(extent, 0.9 * seen) << name;
    EXPECT_GT(seen, 0.25 * take.frames() * take.markers()) << name;  // some have half their labels unused
  };
  expect("sample06/MACsample.c3d", 180, 33);
  const Take old = read_c3d(data / "sample06/MACsample.c3d");
  EXPECT_NEAR(old.at(90, 0).y(), 1449.0, 10.0);  // a shoulder; POINT:SCALE would put it at 0.57 m
  expect("sample10/TYPE-2.C3D", 199, 13);
  expect("sample10/type-4a.c3d", 360, 25);
  expect("sample13/Dance.c3d", 499, 40);      // POINT:FRAMES says 500
  expect("sample13/golfswing.c3d", 514, 29);  // POINT:FRAMES says 515
  expect("sample18/bad_parameter_section.c3d", 332, 45);
  expect("sample20/phasespace_sample.c3d", 701, 40);  // no parameters at all
}

}  // namespace
}  // namespace vultus::mocap
