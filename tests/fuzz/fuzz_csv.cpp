#include "mocap/csv.h"
#include "tests/fuzz/reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vultus::fuzz::check_reader([](const auto& file) { return vultus::mocap::read_csv(file); }, data, size);
  return 0;
}

std::vector<std::string> vultus::fuzz::seeds() {
  return {"time,a_x,a_y,a_z,b.x,b.y,b.z\n0,1,2,3,4,5,6\n0.01,,,,4,5,6\n0.02,1,2,3\n",
          "Frame;A_x;A_y;A_z;note\n1;1,5;2;3;hello\n2;1.5;NA;nan;\n",
          "Format Version,1.23,Take Name,\"take, one\",Export Frame Rate,120.0,Length Units,Meters\n\n"
          ",Type,Rigid Body,Marker,Marker,Marker,Bone Marker,Bone Marker,Bone Marker\n"
          ",Name,hat,F:brow,F:brow,F:brow,F:chin,F:chin,F:chin\n,ID,1,2,2,2,3,3,3\n"
          ",,Rotation,Position,Position,Position,Position,Position,Position\n"
          "Frame,Time (Seconds),X,X,Y,Z,X,Y,Z\n0,0.000,0,0.1,0.2,0.3,0.4,0.5,0.6\n1,0.008,0,,,,0.4,0.5,0.7\n",
          "Devices\n1000\n1,2,3\n\nTrajectories\n100\n,,Actor:brow,,,Actor:chin,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n"
          ",,mm,mm,mm,mm,mm,mm\n1,0,1,2,3,4,5,6\n2,0,,,,4,5,6\n\nModel Outputs\n100\n"};
}
