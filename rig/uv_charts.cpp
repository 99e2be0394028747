#include "rig/uv_charts.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace vultus::rig {
namespace {

std::vector<int> numbered_roots(std::vector<int> parent) {
  const auto find = [&](int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  std::vector<int> number(parent.size(), -1), result(parent.size());
  int next = 0;
  for (int i = 0; i < static_cast<int>(parent.size()); ++i) {
    int& own = number[find(i)];
    if (own < 0) own = next++;
    result[i] = own;
  }
  return result;
}

std::vector<int> chart_of_uv_rows(const Topology& topology) {
  std::vector<int> parent(static_cast<std::size_t>(topology.uvs().rows()));
  std::iota(parent.begin(), parent.end(), 0);
  const auto find = [&](int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const Triangles& uvs = topology.triangle_uvs();
  for (Eigen::Index t = 0; t < uvs.rows(); ++t)
    for (int k = 1; k < 3; ++k) {
      const int a = find(uvs(t, 0)), b = find(uvs(t, k));
      parent[std::max(a, b)] = std::min(a, b);
    }
  return numbered_roots(std::move(parent));
}

std::vector<float> gaussian(double sigma) {
  const int reach = static_cast<int>(std::ceil(3.0 * sigma));
  std::vector<float> kernel(static_cast<std::size_t>(2 * reach + 1));
  for (int i = -reach; i <= reach; ++i)
    kernel[static_cast<std::size_t>(i + reach)] = static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma)));
  return kernel;
}

/// A chart's rectangle of texels with its values; the last plane is 1 inside the chart.
struct ChartPlanes {
  int x0, y0, width, height, planes;
  std::vector<float> values;
  float& at(int plane, int x, int y) { return values[(static_cast<std::size_t>(plane) * height + y) * width + x]; }
};

void convolve(ChartPlanes& chart, const std::vector<float>& kernel, bool along_x) {
  const int reach = static_cast<int>(kernel.size() / 2);
  const int length = along_x ? chart.width : chart.height, lines = along_x ? chart.height : chart.width;
  tbb::parallel_for(0, chart.planes * lines, [&](int job) {
    const int plane = job / lines, line = job % lines;
    std::vector<float> old(static_cast<std::size_t>(length));
    for (int i = 0; i < length; ++i) old[i] = along_x ? chart.at(plane, i, line) : chart.at(plane, line, i);
    for (int i = 0; i < length; ++i) {
      float sum = 0.0F;
      for (int j = std::max(0, i - reach); j <= std::min(length - 1, i + reach); ++j)
        sum += kernel[j - i + reach] * old[j];
      (along_x ? chart.at(plane, i, line) : chart.at(plane, line, i)) = sum;
    }
  });
}

struct Rectangle {
  int x0 = std::numeric_limits<int>::max(), y0 = x0, x1 = -1, y1 = -1;
  bool empty() const { return x1 < x0; }
};

int chart_at(const TextureSpace& texels, const UvCharts& charts, int x, int y) {
  const SurfacePoint& place = texels.at(x, y);
  return place.valid() ? charts.of_triangle[place.triangle] : -1;
}

std::vector<Rectangle> chart_rectangles(const TextureSpace& texels, const UvCharts& charts) {
  std::vector<Rectangle> boxes(charts.count);
  for (int y = 0; y < texels.height(); ++y)
    for (int x = 0; x < texels.width(); ++x) {
      const int chart = chart_at(texels, charts, x, y);
      if (chart < 0) continue;
      Rectangle& box = boxes[chart];
      box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x), std::max(box.y1, y)};
    }
  return boxes;
}

void smooth_chart(const TextureSpace& texels, const UvCharts& charts, int chart, const Rectangle& box, double sigma,
                  Image& image) {
  ChartPlanes planes{box.x0, box.y0, box.x1 - box.x0 + 1, box.y1 - box.y0 + 1, image.channels() + 1, {}};
  planes.values.assign(static_cast<std::size_t>(planes.planes) * planes.width * planes.height, 0.0F);
  const auto each_texel = [&](const auto& visit) {
    for (int y = 0; y < planes.height; ++y)
      for (int x = 0; x < planes.width; ++x)
        if (chart_at(texels, charts, box.x0 + x, box.y0 + y) == chart) visit(x, y, image.at(box.x0 + x, box.y0 + y));
  };
  each_texel([&](int x, int y, const float* texel) {
    for (int c = 0; c < image.channels(); ++c) planes.at(c, x, y) = texel[c];
    planes.at(image.channels(), x, y) = 1.0F;
  });
  const std::vector<float> kernel = gaussian(sigma);
  convolve(planes, kernel, true);
  convolve(planes, kernel, false);
  each_texel([&](int x, int y, float* texel) {
    for (int c = 0; c < image.channels(); ++c) texel[c] = planes.at(c, x, y) / planes.at(image.channels(), x, y);
  });
}

/// Adds the bilinear weights of a chart's texels around (x, y), in texel units with centres at whole numbers.
float add_bilinear(const TextureSpace& texels, const UvCharts& charts, const Image& image, int chart, double x,
                   double y, Eigen::Ref<Eigen::RowVectorXf> sum) {
  float total = 0.0F;
  const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
  for (int dy = 0; dy < 2; ++dy)
    for (int dx = 0; dx < 2; ++dx) {
      const int tx = left + dx, ty = top + dy;
      if (tx < 0 || ty < 0 || tx >= image.width() || ty >= image.height()) continue;
      if (chart_at(texels, charts, tx, ty) != chart) continue;
      const auto weight = static_cast<float>((1.0 - std::abs(x - tx)) * (1.0 - std::abs(y - ty)));
      sum += weight * Eigen::Map<const Eigen::RowVectorXf>(image.at(tx, ty), image.channels());
      total += weight;
    }
  return total;
}

const float* nearest_in_chart(const TextureSpace& texels, const UvCharts& charts, const Image& image, int chart,
                              double x, double y) {
  const float* best = nullptr;
  double best_distance = std::numeric_limits<double>::infinity();
  const int cx = static_cast<int>(std::lround(x)), cy = static_cast<int>(std::lround(y));
  for (int ty = std::max(0, cy - 2); ty <= std::min(image.height() - 1, cy + 2); ++ty)
    for (int tx = std::max(0, cx - 2); tx <= std::min(image.width() - 1, cx + 2); ++tx) {
      const double distance = std::hypot(tx - x, ty - y);
      if (chart_at(texels, charts, tx, ty) != chart || distance >= best_distance) continue;
      best_distance = distance;
      best = image.at(tx, ty);
    }
  return best;
}

}  // namespace

UvCharts uv_charts(const TextureSpace& texels, const Points& positions) {
  const Topology& topology = texels.topology();
  const std::vector<int> of_row = chart_of_uv_rows(topology);
  const Triangles &triangles = topology.triangles(), &uvs = topology.triangle_uvs();
  UvCharts charts;
  charts.of_triangle.resize(static_cast<std::size_t>(triangles.rows()));
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    charts.of_triangle[static_cast<std::size_t>(t)] = of_row[uvs(t, 0)];
    charts.count = std::max(charts.count, of_row[uvs(t, 0)] + 1);
  }
  std::vector<double> skin(charts.count, 0.0), texture(charts.count, 0.0);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::Vector3d a = positions.row(triangles(t, 0)), b = positions.row(triangles(t, 1)),
                          c = positions.row(triangles(t, 2));
    const Eigen::Vector2d p = topology.uvs().row(uvs(t, 0)), q = topology.uvs().row(uvs(t, 1)),
                          r = topology.uvs().row(uvs(t, 2));
    const Eigen::Vector2d e = q - p, f = r - p;
    const int chart = charts.of_triangle[static_cast<std::size_t>(t)];
    skin[chart] += 0.5 * (b - a).cross(c - a).norm();
    texture[chart] += 0.5 * std::abs(e.x() * f.y() - e.y() * f.x()) * texels.width() * texels.height();
  }
  for (int chart = 0; chart < charts.count; ++chart)
    charts.mm_per_texel.push_back(texture[chart] > 0.0 ? std::sqrt(skin[chart] / texture[chart]) : 0.0);
  return charts;
}

void smooth_in_charts(const TextureSpace& texels, const UvCharts& charts, double sigma_mm, Image& image) {
  const std::vector<Rectangle> boxes = chart_rectangles(texels, charts);
  for (int chart = 0; chart < charts.count; ++chart) {
    if (boxes[chart].empty() || !(charts.mm_per_texel[chart] > 0.0)) continue;
    const double sigma = sigma_mm / charts.mm_per_texel[chart];
    // A kernel wider than the chart averages it all the same.
    const double widest = std::max(boxes[chart].x1 - boxes[chart].x0, boxes[chart].y1 - boxes[chart].y0) + 1.0;
    if (sigma > 0.1) smooth_chart(texels, charts, chart, boxes[chart], std::min(sigma, widest), image);
  }
}

Eigen::MatrixXf sample_at_uvs(const TextureSpace& texels, const UvCharts& charts, const Image& image) {
  const Topology& topology = texels.topology();
  const Triangles& uvs = topology.triangle_uvs();
  std::vector<int> chart_of_row(static_cast<std::size_t>(topology.uvs().rows()), -1);
  for (Eigen::Index t = 0; t < uvs.rows(); ++t)
    for (int k = 0; k < 3; ++k) chart_of_row[uvs(t, k)] = charts.of_triangle[static_cast<std::size_t>(t)];
  Eigen::MatrixXf values =
      Eigen::MatrixXf::Constant(topology.uvs().rows(), image.channels(), std::numeric_limits<float>::quiet_NaN());
  for (Eigen::Index row = 0; row < values.rows(); ++row) {
    const int chart = chart_of_row[static_cast<std::size_t>(row)];
    const double x = topology.uvs()(row, 0) * image.width() - 0.5;
    const double y = (1.0 - topology.uvs()(row, 1)) * image.height() - 0.5;
    Eigen::RowVectorXf sum = Eigen::RowVectorXf::Zero(image.channels());
    const float total = add_bilinear(texels, charts, image, chart, x, y, sum);
    if (total > 1e-6F) {
      values.row(row) = sum / total;
    } else if (const float* nearest = nearest_in_chart(texels, charts, image, chart, x, y)) {
      values.row(row) = Eigen::Map<const Eigen::RowVectorXf>(nearest, image.channels());
    }
  }
  return values;
}

}  // namespace vultus::rig
