#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <limits>

#include "core/error.h"
#include "core/image.h"
#include "core/mesh_io.h"
#include "temporary_folder.h"

namespace vultus {
namespace {

using test::TemporaryFolder;
using testing::Test;

template <class Value>
std::string bytes_of(Value value, bool big = false) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return big ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

Mesh quad_and_triangle() {
  TopologyData data;
  data.vertex_count = 5;
  data.face_offsets = {0, 4, 7};
  data.corner_vertex = {0, 1, 2, 3, 1, 4, 2};
  data.corner_uv = {0, 1, 2, 3, 4, 5, 2};
  data.uvs.resize(6, 2);
  data.uvs << 0, 0, 0.5, 0, 0.5, 1, 0, 1, 0.6, 0, 1, 0.25;
  Mesh mesh;
  mesh.topology = Topology::make(data);
  mesh.positions.resize(5, 3);
  mesh.positions << 0, 0, 0, 1, 0, 0.125, 1, 1, 0, 0, 1, -2.5, 2, 0.1, 1e-7;
  return mesh;
}

TEST(Obj, RoundTripKeepsEveryBitOfPolygonsAndUvs) {
  const TemporaryFolder folder;
  const Mesh mesh = quad_and_triangle();
  write_obj(folder / "a.obj", mesh);
  const Mesh read = read_mesh(folder / "a.obj");
  EXPECT_EQ(read.positions, mesh.positions);
  EXPECT_EQ(read.topology->data().face_offsets, mesh.topology->data().face_offsets);
  EXPECT_EQ(read.topology->data().corner_vertex, mesh.topology->data().corner_vertex);
  EXPECT_EQ(read.topology->data().corner_uv, mesh.topology->data().corner_uv);
  EXPECT_EQ(read.topology->uvs(), mesh.topology->uvs());
  EXPECT_FALSE(read.has_colours());
}

TEST(Obj, ReadsNegativeIndicesColoursNormalsAndTexture) {
  const TemporaryFolder folder;
  folder.put("head.mtl", "newmtl skin\nKd 1 1 1\nmap_Kd C:\\scans\\face photo.png\n");
  const auto file = folder.put("a.obj",
                               "# a comment\r\nmtllib head.mtl\r\nv 0 0 0 1 0.5 0\r\nv 1 0 0 1 0.5 0\r\n"
                               "v +1 1 0 1 0.5 0\r\nv 0 1 0 0 0 1\r\nvt 0 0\r\nvt 1 0\r\nvt 1 1\r\nvn 0 0 1\r\n"
                               "g nose\r\ns off\r\nf -4/-3/1 -3/-2/1 -2/-1/1\r\nf 1/1 3/3 4/2\r\n");
  const Mesh mesh = read_mesh(file);
  ASSERT_EQ(mesh.positions.rows(), 4);
  EXPECT_EQ(mesh.topology->triangles(), (Triangles(2, 3) << 0, 1, 2, 0, 2, 3).finished());
  EXPECT_EQ(mesh.topology->triangle_uvs(), (Triangles(2, 3) << 0, 1, 2, 0, 2, 1).finished());
  EXPECT_EQ(mesh.texture, (folder / "face photo.png").string());
  ASSERT_TRUE(mesh.has_colours());
  EXPECT_EQ(mesh.colours(0, 1), 0.5);
}

TEST(Obj, FacesMayNameLaterVerticesAndLackUvs) {
  const TemporaryFolder folder;
  const Mesh mesh = read_mesh(folder.put("a.obj", "vt 0 0\nf 1//1 2//1 3//1\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"));
  EXPECT_EQ(mesh.topology->face_count(), 1);
  EXPECT_FALSE(mesh.topology->has_uvs());
}

struct Hostile {
  const char* name;
  std::string content;
  const char* expected;
};

void expect_refused(const Hostile& hostile) {
  SCOPED_TRACE(hostile.name);
  const TemporaryFolder folder;
  const auto file = folder.put(hostile.name, hostile.content);
  const std::string message = test::message_of<InputError>([&] { read_mesh(file); });
  EXPECT_NE(message.find(file.string()), std::string::npos) << message;
  EXPECT_NE(message.find(hostile.expected), std::string::npos) << message;
}

TEST(Obj, RefusesHostileFilesWithTheLine) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (const Hostile& hostile : std::initializer_list<Hostile>{
           {"empty.obj", "", "is empty"},
           {"no_vertices.obj", "hello\nworld\n", "no vertices"},
           {"word.obj", "v 0 0 zero\n", "line 1"},
           {"short.obj", "v 0 0 0\nv 1 1\n", "line 2"},
           {"zero.obj", corners + "f 0 1 2\n", "line 4"},
           {"past_end.obj", corners + "\nf 1 2 4\nf 1 2 3\n", "line 5: vertex 4 of 3"},
           {"before_start.obj", corners + "f -4 1 2\n", "line 4"},
           {"huge_index.obj", corners + "f 1 2 99999999999\n", "line 4"},
           {"overflow.obj", corners + "f 1 2 99999999999999999999999\n", "line 4"},
           {"two_corners.obj", corners + "f 1 2\n", "line 4"},
           {"half_uvs.obj", corners + "vt 0 0\nf 1/1 2 3\n", "line 5"},
           {"uv_past_end.obj", corners + "vt 0 0\nf 1/1 2/2 3/1\n", "UV 2 of 1"},
           {"nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "vertex 1"},
           {"infinite.obj", "v 0 0 0\nv 1e999 0 0\n", "line 2"},
       }) {
    expect_refused(hostile);
  }
}

TEST(Obj, KeepsNanOnlyWhenAsked) {
  const TemporaryFolder folder;
  const auto file = folder.put("a.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THROW(read_mesh(file), InputError);
  EXPECT_TRUE(std::isnan(read_mesh(file, NonFinite::keep).positions(1, 0)));
}

TEST(Ply, RoundTripKeepsFloatsPolygonsAndColours) {
  const TemporaryFolder folder;
  Mesh mesh = quad_and_triangle();
  mesh.colours = Points::Zero(5, 3);
  for (int v = 0; v < 5; ++v) mesh.colours(v, v % 3) = linear_from_srgb(static_cast<float>(50 * v) / 255.0f);
  write_ply(folder / "a.ply", mesh);
  const Mesh read = read_mesh(folder / "a.ply");
  EXPECT_EQ(read.positions.cast<float>(), mesh.positions.cast<float>());
  EXPECT_EQ(read.topology->data().face_offsets, mesh.topology->data().face_offsets);
  EXPECT_EQ(read.topology->data().corner_vertex, mesh.topology->data().corner_vertex);
  ASSERT_TRUE(read.has_colours());
  // Colours that stand exactly on a byte come back exactly, but for float rounding.
  EXPECT_LT((read.colours - mesh.colours).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Ply, PointsRoundTripWithoutFaces) {
  const TemporaryFolder folder;
  Points points(2, 3);
  points << 1, 2, 3, -4, 5.5, 6;
  write_ply_points(folder / "a.ply", points, Points::Ones(2, 3));
  const Mesh read = read_mesh(folder / "a.ply");
  EXPECT_EQ(read.positions, points);
  EXPECT_EQ(read.topology->face_count(), 0);
}

// Lists before scalars, an element nobody knows, doubles, shuffled coordinates and 16-bit list counts.
std::string awkward_ply(bool big) {
  std::string text =
      std::string("ply\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") +
      " 1.0\ncomment TextureFile photo.jpg\nelement camera 2\nproperty list uchar short curve\n"
      "property double zoom\nelement vertex 3\nproperty uchar blue\nproperty double z\nproperty float x\n"
      "property list int int rings\nproperty float y\nproperty uchar red\nproperty uchar green\n"
      "element face 1\nproperty uchar flags\nproperty list ushort uint vertex_index\nend_header\n";
  for (int camera = 0; camera < 2; ++camera) {
    text += bytes_of(std::uint8_t(camera));
    for (int k = 0; k < camera; ++k) text += bytes_of(std::int16_t(-7), big);
    text += bytes_of(1.5, big);
  }
  for (int v = 0; v < 3; ++v) {
    text += bytes_of(std::uint8_t(255)) + bytes_of(30.0 + v, big) + bytes_of(10.0f + v, big) +
            bytes_of(std::int32_t(1), big) + bytes_of(std::int32_t(99), big) + bytes_of(20.0f + v, big) +
            bytes_of(std::uint8_t(0)) + bytes_of(std::uint8_t(0));
  }
  text += bytes_of(std::uint8_t(0)) + bytes_of(std::uint16_t(3), big);
  for (std::uint32_t v = 0; v < 3; ++v) text += bytes_of(2 - v, big);
  return text;
}

TEST(Ply, ReadsBothByteOrdersAndSkipsWhatItDoesNotKnow) {
  const TemporaryFolder folder;
  for (const bool big : {false, true}) {
    const Mesh mesh = read_mesh(folder.put("a.ply", awkward_ply(big)));
    EXPECT_EQ(mesh.positions, (Points(3, 3) << 10, 20, 30, 11, 21, 31, 12, 22, 32).finished());
    EXPECT_EQ(mesh.topology->triangles(), (Triangles(1, 3) << 2, 1, 0).finished());
    EXPECT_EQ(mesh.colours.row(0), Eigen::RowVector3d(0, 0, 1));
    EXPECT_EQ(mesh.texture, (folder / "photo.jpg").string());
  }
}

TEST(Ply, EveryTruncationIsRefusedWithAByte) {
  const TemporaryFolder folder;
  const std::string whole = awkward_ply(true);
  const std::size_t body = whole.find("end_header\n") + 11;
  for (std::size_t size = body; size < whole.size(); ++size) {
    const auto file = folder.put("a.ply", whole.substr(0, size));
    EXPECT_NE(test::message_of<InputError>([&] { read_mesh(file); }).find("byte "), std::string::npos) << size;
  }
}

TEST(Ply, ReadsAsciiWithFloatColoursAndTextureCoordinates) {
  const TemporaryFolder folder;
  const Mesh mesh =
      read_mesh(folder.put("a.ply",
                           "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                           "property float z\nproperty float red\nproperty float green\nproperty float blue\n"
                           "property float s\nproperty float t\nelement face 1\n"
                           "property list uchar int vertex_indices\nend_header\n"
                           "0 0 0 0.25 1 0 0 0\n1 0 0 0 0 0 1 0\n0 1 0 0 0 0 0 1\n3 0 1 2"));
  EXPECT_EQ(mesh.colours(0, 0), 0.25);
  ASSERT_TRUE(mesh.topology->has_uvs());
  EXPECT_EQ(mesh.topology->uvs().row(mesh.topology->triangle_uvs()(0, 2)), Eigen::RowVector2d(0, 1));
}

TEST(Ply, RefusesHostileFilesWithThePlace) {
  const std::string head = "ply\nformat ascii 1.0\n";
  const std::string vertex = "property float x\nproperty float y\nproperty float z\n";
  const std::string face = "element face 1\nproperty list uchar int vertex_indices\n";
  const std::string three = "0 0 0\n1 0 0\n0 1 0\n";
  const std::string huge_list = "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" + vertex +
                                "property list uint double rings\nend_header\n" + std::string(12, '\0') +
                                "\xff\xff\xff\xff";
  for (const Hostile& hostile : std::initializer_list<Hostile>{
           {"only_magic.ply", "ply\n", "line 1"},
           {"wrong_type.ply", "solid cube\n", "byte 0"},
           {"no_end.ply", head + "element vertex 1\n" + vertex, "end_header"},
           {"format.ply", "ply\nformat binary_middle_endian 1.0\nend_header\n", "line 2"},
           {"type.ply", head + "element vertex 1\nproperty quad x\nend_header\n", "line 4"},
           {"float_count.ply", head + "element vertex 1\nproperty list float int x\nend_header\n", "line 4"},
           {"orphan.ply", head + "property float x\nend_header\n", "line 3"},
           {"count.ply", head + "element vertex -5\n" + vertex + "end_header\n", "line 3"},
           {"absurd.ply", head + "element vertex 2000000000\n" + vertex + "end_header\n0 0 0\n",
            "too short for 2000000000"},
           {"absurd64.ply", head + "element vertex 18446744073709551615\n" + vertex + "end_header\n0 0 0\n",
            "too short"},
           {"empty_rows.ply", head + "element vertex 18446744073709551615\nend_header\n", "too short"},
           {"no_xyz.ply", head + "element vertex 1\nproperty float x\nend_header\n0\n", "no x, y and z"},
           {"no_vertices.ply", head + "element vertex 0\n" + vertex + "end_header\n", "no vertices"},
           {"word.ply", head + "element vertex 1\n" + vertex + "end_header\n0 zero 0\n", "line 8"},
           {"index.ply", head + "element vertex 3\n" + vertex + face + "end_header\n" + three + "3 0 1 3\n", "face 0"},
           {"negative.ply", head + "element vertex 3\n" + vertex + face + "end_header\n" + three + "3 0 1 -1\n",
            "line 13"},
           {"two.ply", head + "element vertex 3\n" + vertex + face + "end_header\n" + three + "2 0 1\n",
            "fewer than 3"},
           {"long_list.ply", head + "element vertex 3\n" + vertex + face + "end_header\n" + three + "255 0 1\n",
            "list of 255"},
           {"huge_list.ply", huge_list, "does not fit"},
           {"nan.ply", head + "element vertex 1\n" + vertex + "end_header\n0 nan 0\n", "vertex 0"},
       }) {
    expect_refused(hostile);
  }
}

std::string binary_stl(std::uint32_t declared, int held) {
  std::string text(80, ' ');
  text.replace(0, 5, "solid");  // as some exporters do
  text += bytes_of(declared);
  for (int t = 0; t < held; ++t) {
    const float x = static_cast<float>(t);
    for (const float value : {0.f, 0.f, 1.f, x, 0.f, 0.f, x + 1, -0.f, 0.f, x, 1.f, 0.f}) text += bytes_of(value);
    text += bytes_of(std::uint16_t(0));
  }
  return text;
}

TEST(Stl, WeldsEqualCornersOfBinaryFiles) {
  const TemporaryFolder folder;
  const Mesh mesh = read_mesh(folder.put("a.stl", binary_stl(2, 2)));
  // (0 0 0) (1 0 0) (0 1 0) and (1 0 0) again, (2 0 0), (1 1 0): -0 and 0 are one place.
  EXPECT_EQ(mesh.positions.rows(), 5);
  EXPECT_EQ(mesh.topology->triangles(), (Triangles(2, 3) << 0, 1, 2, 1, 3, 4).finished());
}

TEST(Stl, ReadsAscii) {
  const TemporaryFolder folder;
  const Mesh mesh =
      read_mesh(folder.put("a.stl",
                           "solid a\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1e0 0 0\n"
                           "   vertex 0 1 0\n  endloop\n endfacet\nendsolid a\n"));
  EXPECT_EQ(mesh.positions, (Points(3, 3) << 0, 0, 0, 1, 0, 0, 0, 1, 0).finished());
}

TEST(Stl, RefusesHostileFiles) {
  for (const Hostile& hostile : std::initializer_list<Hostile>{
           {"short.stl", std::string(40, '\0'), "too short"},
           {"truncated.stl", binary_stl(5, 2), "byte 184"},
           {"absurd.stl", binary_stl(0xffffffffu, 1), "1 of 4294967295"},
           {"none.stl", binary_stl(0, 0), "no triangles"},
           {"word.stl", "solid a\nfacet\nvertex 0 zero 0\n", "line 3"},
           {"unfinished.stl", "solid a\nfacet\nvertex 0 0 0\nendfacet\nendsolid\n", "line 4"},
           {"cut.stl", "solid a\nfacet\nvertex 0 0 0\n", "endsolid"},
           {"nan.stl", "solid a\nvertex 0 0 0\nvertex nan 0 0\nvertex 0 1 0\nendfacet\nendsolid\n", "vertex 1"},
       }) {
    expect_refused(hostile);
  }
}

TEST(MeshFiles, RefusesWhatIsNoFile) {
  const TemporaryFolder folder;
  EXPECT_NE(test::message_of<InputError>([&] { read_mesh(folder / "none.obj"); }).find("No such file"),
            std::string::npos);
  EXPECT_NE(test::message_of<InputError>([&] { read_mesh(folder.path()); }).find("folder"), std::string::npos);
  EXPECT_NE(test::message_of<InputError>([&] { read_mesh(folder.put("a.txt", "v 0 0 0")); }).find("OBJ, PLY and STL"),
            std::string::npos);
  if (::geteuid() != 0) {
    const auto locked = folder.put("locked.obj", "v 0 0 0\n");
    std::filesystem::permissions(locked, std::filesystem::perms::none);
    EXPECT_NE(test::message_of<InputError>([&] { read_mesh(locked); }).find("Permission denied"), std::string::npos);
  }
}

}  // namespace
}  // namespace vultus
