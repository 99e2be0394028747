#include <gtest/gtest.h>

#include <sstream>

#include "core/error.h"
#include "mocap/axes.h"
#include "mocap/csv.h"
#include "mocap/marker_names.h"
#include "mocap/trc.h"
#include "tests/unit/mocap/takes.h"

namespace vultus::mocap {
namespace {

class TextTakes : public InFolder {
 protected:
  /// The message of the InputError that reading gives.
  std::string refusal(const std::string& name, const std::string& content) const {
    try {
      read_take(write(name, content));
    } catch (const InputError& error) {
      return error.what();
    }
    return "read without complaint";
  }
};

const std::string kTrc =
    "PathFileType\t4\t(X/Y/Z)\tt.trc\r\n"
    "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\r\n"
    "60.00\t60.00\t3\t2\tcm\t60\t1\t3\r\n"
    "Frame#\tTime\tbrow\t\t\tchin\t\t\r\n"
    "\t\tX1\tY1\tZ1\tX2\tY2\tZ2\r\n"
    "\r\n"
    "1\t0.0\t1\t2\t3\t4\t5\t6\r\n"
    "2\t0.017\t\t\t\t4.5\t5\t6\r\n"
    "3\t0.033\t1.5\t2\t3\r\n";

TEST_F(TextTakes, TrcByHand) {
  const Take take = read_trc(write("t.trc", kTrc));
  EXPECT_EQ(take.labels, (std::vector<std::string>{"brow", "chin"}));
  EXPECT_DOUBLE_EQ(take.rate_hz, 60.0);
  ASSERT_EQ(take.frames(), 3);
  EXPECT_EQ(take.at(0, 0), Eigen::Vector3d(10, 20, 30));
  EXPECT_FALSE(take.has(1, 0));
  EXPECT_EQ(take.at(1, 1), Eigen::Vector3d(45, 50, 60));
  EXPECT_FALSE(take.has(2, 1));  // the row ends early
}

TEST_F(TextTakes, TrcRefusalsNameTheLine) {
  EXPECT_NE(refusal("a.trc", "").find("empty"), std::string::npos);
  EXPECT_NE(refusal("b.trc", kTrc.substr(0, 60)).find("line"), std::string::npos);
  std::string wrong = kTrc;
  wrong.replace(wrong.find("4.5"), 3, "4x5");
  EXPECT_NE(refusal("c.trc", wrong).find("line 8"), std::string::npos) << refusal("c.trc", wrong);
  std::string absurd = kTrc;
  absurd.replace(absurd.find("\t3\t2\tcm"), 7, "\t3\t999999\tcm");
  EXPECT_NE(refusal("d.trc", absurd).find("line 3"), std::string::npos);
  std::string more = kTrc;
  more.replace(more.find("\t3\t2\tcm"), 7, "\t9\t2\tcm");
  EXPECT_NE(refusal("e.trc", more).find("3 of 9 frames"), std::string::npos);
}

TEST_F(TextTakes, TrcWrittenReadsBackBitForBit) {
  Take take = random_take(20, 7, 9);
  take.first_frame = 12;
  write_trc(folder / "w.trc", take);
  const Take read = read_trc(folder / "w.trc");
  EXPECT_EQ(read.labels, take.labels);
  EXPECT_EQ(read.present, take.present);
  EXPECT_DOUBLE_EQ(read.rate_hz, take.rate_hz);
  for (std::size_t i = 0; i < take.present.size(); ++i) {
    for (std::size_t c = 0; c < 3 && take.present[i] != 0; ++c)
      ASSERT_EQ(read.positions[3 * i + c], take.positions[3 * i + c]);
  }
}

TEST_F(TextTakes, PlainTableWithSemicolonsNaAndDecimalCommas) {
  ReadOptions options;
  options.unit = "cm";
  options.rate_hz = 25.0;
  const Take take = read_csv(write("s.csv",
                                   "Frame;A_x;A_y;A_z;note;B_x;B_y;B_z\n"
                                   "1;1,5;2;3;hello;NA;NA;NA\n"
                                   "2;1.5;2;NA;;7;8;9\n"),
                             options);
  EXPECT_EQ(take.labels, (std::vector<std::string>{"A", "B"}));
  EXPECT_DOUBLE_EQ(take.rate_hz, 25.0);
  EXPECT_EQ(take.at(0, 0), Eigen::Vector3d(15, 20, 30));
  EXPECT_FALSE(take.has(0, 1));
  EXPECT_FALSE(take.has(1, 0));
  EXPECT_EQ(take.at(1, 1), Eigen::Vector3d(70, 80, 90));
}

TEST_F(TextTakes, PlainTableTakesItsRateFromTheTimes) {
  const Take take =
      read_csv(write("t.csv", "frame,time,a_x,a_y,a_z\n1,0,100,2,3\n2,0.0083,100,2,3\n3,0.0167,100,2,3\n"));
  EXPECT_DOUBLE_EQ(take.rate_hz, 120.0);
}

TEST_F(TextTakes, MotiveExport) {
  const Take take =
      read_csv(write("motive.csv",
                     "Format Version,1.23,Take Name,\"take, one\",Capture Frame Rate,240.0,Export Frame "
                     "Rate,120.0,Length Units,Meters\n"
                     "\n"
                     ",Type,Rigid Body,Rigid Body,Rigid Body,Marker,Marker,Marker,Marker,Marker,Marker\n"
                     ",Name,hat,hat,hat,Face:brow,Face:brow,Face:brow,Face:chin,Face:chin,Face:chin\n"
                     ",ID,1,1,1,2,2,2,3,3,3\n"
                     ",,Rotation,Rotation,Rotation,Position,Position,Position,Position,Position,Position\n"
                     "Frame,Time (Seconds),X,Y,Z,X,Y,Z,X,Y,Z\n"
                     "0,0.000,0,0,0,0.1,0.2,0.3,0.4,0.5,0.6\n"
                     "1,0.008,0,0,0,,,,0.4,0.5,0.7\n"));
  EXPECT_EQ(take.labels, (std::vector<std::string>{"brow", "chin"}));
  EXPECT_DOUBLE_EQ(take.rate_hz, 120.0);
  EXPECT_TRUE(take.at(0, 0).isApprox(Eigen::Vector3d(100, 200, 300), 1e-6));
  EXPECT_FALSE(take.has(1, 0));
  EXPECT_TRUE(take.at(1, 1).isApprox(Eigen::Vector3d(400, 500, 700), 1e-6));
}

TEST_F(TextTakes, ViconExportIsZUp) {
  const Take take = read_csv(write("vicon.csv",
                                   "Devices\n1000\n1,2,3\n\nTrajectories\n100\n"
                                   ",,Actor:brow,,,Actor:chin,,\n"
                                   "Frame,Sub Frame,X,Y,Z,X,Y,Z\n"
                                   ",,mm,mm,mm,mm,mm,mm\n"
                                   "1,0,1,2,3,4,5,6\n"
                                   "2,0,,,,4,5,6\n"
                                   "\nModel Outputs\n100\n"));
  EXPECT_EQ(take.labels, (std::vector<std::string>{"brow", "chin"}));
  ASSERT_EQ(take.frames(), 2);
  EXPECT_EQ(take.at(0, 0), Eigen::Vector3d(1, 3, -2));  // z up becomes y up
  EXPECT_FALSE(take.has(1, 0));
}

TEST_F(TextTakes, CsvRefusals) {
  EXPECT_NE(refusal("a.csv", "").find("empty"), std::string::npos);
  EXPECT_NE(refusal("b.csv", "time,jawOpen\n0,0.5\n").find("no marker columns"), std::string::npos);
  EXPECT_NE(refusal("c.csv", "a_x,a_y\n1,2\n").find("no column for z"), std::string::npos);
  EXPECT_NE(refusal("d.csv", "a_x,a_y,a_z\n1,2,3\n1,two,3\n").find("line 3"), std::string::npos);
  EXPECT_NE(refusal("e.csv", "a_x,a_y,a_z\n").find("no frames"), std::string::npos);
  EXPECT_NE(refusal("f.bin", "a_x,a_y,a_z\n").find("neither"), std::string::npos);
  EXPECT_THROW(read_take(folder / "missing.csv"), InputError);
  EXPECT_THROW(write_take(folder / "take.fbx", random_take(2, 2, 1)), OutputError);
}

TEST_F(TextTakes, DamagedTextNeverCrashes) {
  const std::string motive =
      "Format Version,1.2\n\n,Type,Marker,Marker,Marker\n,Name,a,a,a\n,,Position,Position,Position\n"
      "Frame,Time,X,Y,Z\n0,0,1,2,3\n";
  const std::string vicon = "Trajectories\n100\n,,a,,\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n1,0,1,2,3\n";
  Random random(31);
  for (const auto& [name, whole] : {std::pair<std::string, std::string>{"t.trc", kTrc},
                                    {"m.csv", motive},
                                    {"v.csv", vicon},
                                    {"p.csv", "time,a_x,a_y,a_z\n0,1,2,3\n1,4,5,6\n"}}) {
    for (int round = 0; round < 600; ++round) {
      std::string text = whole.substr(0, static_cast<std::size_t>(random.below(static_cast<int>(whole.size()) + 1)));
      const int changes = random.below(4);
      for (int i = 0; i < changes && !text.empty(); ++i) {
        const char* alphabet = "0129.-,;\t\n\"XeN\x01\xff";
        text[static_cast<std::size_t>(random.below(static_cast<int>(text.size())))] = alphabet[random.below(17)];
      }
      try {
        const Take take = read_take(write(name, text));
        ASSERT_LE(take.present.size(), text.size());
      } catch (const InputError&) {
      }
    }
  }
}

TEST(Axes, EveryUpAxisIsARotationToPlusY) {
  for (const std::string up : {"x", "-x", "y", "-y", "z", "-z", "+Z"}) {
    const auto axes = axes_from_up(up);
    ASSERT_TRUE(axes) << up;
    EXPECT_EQ(axes->cast<double>().determinant(), 1.0) << up;
    const int letter = std::tolower(up.back()) - 'x';
    Eigen::Vector3i source = Eigen::Vector3i::Unit(letter);
    if (up[0] == '-') source = -source;
    EXPECT_EQ(*axes * source, Eigen::Vector3i::UnitY()) << up;
  }
  EXPECT_FALSE(axes_from_up("w"));
  EXPECT_FALSE(axes_from_screen("+X", "-X"));
}

TEST(Axes, UnitsAreGuessedFromAFacesSize) {
  for (const auto& [scale, unit] : {std::pair(1.0, "mm"), {0.1, "cm"}, {0.001, "m"}}) {
    Take take = Take::empty("t", 60.0, numbered("m", 30), 3);
    const Points face = face_markers(30);
    for (int f = 0; f < 3; ++f) {
      for (int m = 0; m < 30; ++m) take.set(f, m, scale * Eigen::Vector3d(face.row(m)));
    }
    to_our_frame(take, {}, {});
    EXPECT_LT((take.at(1, 4) - Eigen::Vector3d(face.row(4))).norm(), 1e-4) << unit;
    EXPECT_NE(take.decisions[0].find(std::string(" ") + unit + ","), std::string::npos) << take.decisions[0];
  }
}

TEST(MarkerNames, MadeUnique) {
  std::vector<std::string> decisions;
  EXPECT_EQ(unique_names({"a", "", "a", "a_2", "a"}, 6, decisions),
            (std::vector<std::string>{"a", "point_2", "a_3", "a_2", "a_4", "point_6"}));
  EXPECT_EQ(decisions.size(), 3U);
}

TEST(TextTakesReal, TheThreeFormsOfAnimFaceAgree) {
  const auto data = real_data() / "animface-markers";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "VULTUS_DATA has no animface-markers";
  const Take c3d = read_take(data / "Jaw.c3d");
  for (const char* name : {"Jaw.trc", "Jaw.csv"}) {
    const Take take = read_take(data / name);
    ASSERT_EQ(take.labels, c3d.labels);
    ASSERT_EQ(take.present, c3d.present);
    for (std::size_t i = 0; i < take.positions.size(); ++i) {
      ASSERT_NEAR(take.positions[i], c3d.positions[i], 1e-3) << name;  // the digits of the text files
    }
  }
}

TEST(TextTakesReal, SamplesReadOrAreRefusedForTheRightReason) {
  const auto data = real_data() / "c3d-samples/TRCSamples";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "VULTUS_DATA has no c3d-samples";
  EXPECT_EQ(read_take(data / "Gait.trc").markers(), 66);
  EXPECT_EQ(read_take(data / "Knee.trc").frames(), 200);
  EXPECT_EQ(read_take(data / "MOTEK/T.trc").frames(), 89);
  EXPECT_THROW(read_take(data / "Empty.trc"), InputError);
  EXPECT_THROW(read_take(data / "Truncated.trc"), InputError);
}

TEST(TextTakesReal, BlenderFaceKeepsItsHoles) {
  const auto data = real_data() / "blenderface-markers";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "VULTUS_DATA has no blenderface-markers";
  const Take take = read_take(data / "Subject_01.csv");
  EXPECT_EQ(take.markers(), 16);
  EXPECT_EQ(take.frames(), 1714);
  EXPECT_FALSE(take.has(0, 0));
}

}  // namespace
}  // namespace vultus::mocap
