#include "register/subdivide.h"

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/error.h"

// GCC 12 does not see that OpenSubdiv's mask of an edge fills both weights it declares without a value.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"

namespace vultus::registration {
namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

namespace {

// A row of an n×k array in the form OpenSubdiv's refiners ask for.
template <int size>
struct Row {
  Eigen::Matrix<double, 1, size> value = Eigen::Matrix<double, 1, size>::Zero();
  void Clear(void* = nullptr) { value.setZero(); }
  void AddWithWeight(const Row& other, double weight) { value += weight * other.value; }
};

std::unique_ptr<Far::TopologyRefiner> make_refiner(const Topology& control, int levels) {
  const Triangles& triangles = control.triangles();
  const std::vector<int> sizes(triangles.rows(), 3);
  Far::TopologyDescriptor::FVarChannel uv_channel;
  uv_channel.numValues = static_cast<int>(control.uvs().rows());
  uv_channel.valueIndices = control.triangle_uvs().data();

  Far::TopologyDescriptor descriptor;
  descriptor.numVertices = control.vertex_count();
  descriptor.numFaces = static_cast<int>(triangles.rows());
  descriptor.numVertsPerFace = sizes.data();
  descriptor.vertIndicesPerFace = triangles.data();
  descriptor.numFVarChannels = control.has_uvs() ? 1 : 0;
  descriptor.fvarChannels = &uv_channel;

  Sdc::Options scheme;
  scheme.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
  scheme.SetFVarLinearInterpolation(Sdc::Options::FVAR_LINEAR_BOUNDARIES);
  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  std::unique_ptr<Far::TopologyRefiner> refiner(
      Factory::Create(descriptor, Factory::Options(Sdc::SCHEME_LOOP, scheme)));
  if (!refiner) throw InputError("mesh cannot be subdivided: its triangles do not form a surface");
  Far::TopologyRefiner::UniformOptions uniform(levels);
  uniform.fullTopologyInLastLevel = true;
  refiner->RefineUniform(uniform);
  return refiner;
}

std::vector<int> refined_set(const Far::TopologyRefiner& refiner, const std::vector<int>& control_set) {
  std::vector<char> inside(refiner.GetLevel(0).GetNumVertices(), 0);
  for (int vertex : control_set) inside[vertex] = 1;
  for (int l = 0; l < refiner.GetMaxLevel(); ++l) {
    const Far::TopologyLevel& level = refiner.GetLevel(l);
    std::vector<char> child(refiner.GetLevel(l + 1).GetNumVertices(), 0);
    for (int v = 0; v < level.GetNumVertices(); ++v) child[level.GetVertexChildVertex(v)] = inside[v];
    for (int e = 0; e < level.GetNumEdges(); ++e) {
      const Far::ConstIndexArray ends = level.GetEdgeVertices(e);
      child[level.GetEdgeChildVertex(e)] = inside[ends[0]] && inside[ends[1]];
    }
    inside = std::move(child);
  }
  std::vector<int> set;
  for (int v = 0; v < static_cast<int>(inside.size()); ++v)
    if (inside[v]) set.push_back(v);
  return set;
}

Uvs refined_uvs(const Far::TopologyRefiner& refiner, const Uvs& control_uvs) {
  std::vector<Row<2>> values(control_uvs.rows());
  for (int i = 0; i < control_uvs.rows(); ++i) values[i].value = control_uvs.row(i);
  const Far::PrimvarRefinerReal<double> interpolation(refiner);
  for (int l = 1; l <= refiner.GetMaxLevel(); ++l) {
    std::vector<Row<2>> next(refiner.GetLevel(l).GetNumFVarValues(0));
    Row<2>* target = next.data();
    interpolation.InterpolateFaceVarying(l, values.data(), target, 0);
    values = std::move(next);
  }
  Uvs uvs(values.size(), 2);
  for (int i = 0; i < uvs.rows(); ++i) uvs.row(i) = values[i].value;
  return uvs;
}

std::shared_ptr<const Topology> refined_topology(const Far::TopologyRefiner& refiner, const Topology& control) {
  const Far::TopologyLevel& finest = refiner.GetLevel(refiner.GetMaxLevel());
  TopologyData data;
  data.vertex_count = finest.GetNumVertices();
  data.face_offsets.push_back(0);
  for (int f = 0; f < finest.GetNumFaces(); ++f) {
    const Far::ConstIndexArray corners = finest.GetFaceVertices(f);
    data.corner_vertex.insert(data.corner_vertex.end(), corners.begin(), corners.end());
    data.face_offsets.push_back(static_cast<int>(data.corner_vertex.size()));
    if (control.has_uvs()) {
      const Far::ConstIndexArray uvs = finest.GetFaceFVarValues(f, 0);
      data.corner_uv.insert(data.corner_uv.end(), uvs.begin(), uvs.end());
    }
  }
  if (control.has_uvs()) data.uvs = refined_uvs(refiner, control.uvs());
  for (const auto& [name, vertices] : control.sets()) data.sets[name] = refined_set(refiner, vertices);
  data.landmarks = control.landmarks();
  return Topology::make(std::move(data));
}

// Every name and index the caller holds relies on control vertices keeping their number.
void check_vertex_order(const Far::TopologyRefiner& refiner) {
  for (int l = 0; l < refiner.GetMaxLevel(); ++l) {
    const Far::TopologyLevel& level = refiner.GetLevel(l);
    for (int v = 0; v < level.GetNumVertices(); ++v)
      if (level.GetVertexChildVertex(v) != v)
        throw InputError("mesh cannot be subdivided: vertex " + std::to_string(v) + " belongs to no face");
  }
}

}  // namespace

struct LoopSubdivision::Stencils {
  std::unique_ptr<const Far::StencilTableReal<double>> table;
};

LoopSubdivision::LoopSubdivision(std::shared_ptr<const Topology> control, int levels) : control_(std::move(control)) {
  if (levels < 0 || levels > 6) throw InputError("subdivision levels must be 0 to 6, not " + std::to_string(levels));
  if (levels == 0) {
    refined_ = control_;
    return;
  }
  const std::unique_ptr<Far::TopologyRefiner> refiner = make_refiner(*control_, levels);
  check_vertex_order(*refiner);
  refined_ = refined_topology(*refiner, *control_);

  Far::StencilTableFactoryReal<double>::Options options;
  options.generateIntermediateLevels = false;
  options.generateOffsets = true;
  auto stencils = std::make_shared<Stencils>();
  stencils->table.reset(Far::StencilTableFactoryReal<double>::Create(*refiner, options));
  stencils_ = std::move(stencils);
}

Points LoopSubdivision::operator()(const Points& control_positions) const {
  if (control_positions.rows() != control_->vertex_count())
    throw InputError("subdivision of a mesh with " + std::to_string(control_->vertex_count()) + " vertices was given " +
                     std::to_string(control_positions.rows()) + " positions");
  if (!stencils_) return control_positions;
  Points refined(refined_->vertex_count(), 3);
  // Positions are packed rows of three doubles on both sides, as `Row<3>` is.
  static_assert(sizeof(Row<3>) == 3 * sizeof(double) && Points::IsRowMajor);
  const auto* source = reinterpret_cast<const Row<3>*>(control_positions.data());
  auto* target = reinterpret_cast<Row<3>*>(refined.data());
  stencils_->table->UpdateValues(source, target);
  return refined;
}

}  // namespace vultus::registration
