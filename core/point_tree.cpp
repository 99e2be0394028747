#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "core/neighbours.h"

namespace vultus {

/// Balanced tree over a permutation of the points: the middle of each range splits its widest axis, the halves follow.
struct PointTree::Impl {
  static constexpr int leaf_size = 8;
  Points points;
  std::vector<int> order;
  std::vector<signed char> axis;  // of the split at each middle

  explicit Impl(const Points& given) : points(given), order(given.rows()), axis(given.rows(), -1) {
    if (!given.allFinite()) throw InputError("k-d tree: a point is not finite");
    std::iota(order.begin(), order.end(), 0);
    build(0, static_cast<int>(order.size()));
  }

  void build(int begin, int end) {
    if (end - begin <= leaf_size) return;
    Eigen::RowVector3d low = points.row(order[begin]), high = low;
    for (int i = begin; i < end; ++i) {
      low = low.cwiseMin(points.row(order[i]));
      high = high.cwiseMax(points.row(order[i]));
    }
    int widest;
    (high - low).maxCoeff(&widest);
    const int middle = begin + (end - begin) / 2;
    std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end, [&](int a, int b) {
      return points(a, widest) != points(b, widest) ? points(a, widest) < points(b, widest) : a < b;
    });
    axis[middle] = static_cast<signed char>(widest);
    build(begin, middle);
    build(middle + 1, end);
  }

  /// Max-heap of the k best so far by (squared distance, index).
  struct Search {
    Eigen::RowVector3d point;
    std::size_t k;
    std::vector<std::pair<double, int>> heap;
    void offer(double squared, int index) {
      const std::pair candidate(squared, index);
      if (heap.size() == k) {
        if (!(candidate < heap.front())) return;
        std::pop_heap(heap.begin(), heap.end());
        heap.pop_back();
      }
      heap.push_back(candidate);
      std::push_heap(heap.begin(), heap.end());
    }
  };

  void visit(Search& search, int begin, int end) const {
    if (end - begin <= leaf_size) {
      for (int i = begin; i < end; ++i) search.offer((points.row(order[i]) - search.point).squaredNorm(), order[i]);
      return;
    }
    const int middle = begin + (end - begin) / 2;
    const int split = order[middle];
    search.offer((points.row(split) - search.point).squaredNorm(), split);
    const double offset = search.point[axis[middle]] - points(split, axis[middle]);
    const auto below = [&] { visit(search, begin, middle); };
    const auto above = [&] { visit(search, middle + 1, end); };
    const auto reaches = [&] { return search.heap.size() < search.k || offset * offset <= search.heap.front().first; };
    if (offset < 0) {
      below();
      if (reaches()) above();
    } else {
      above();
      if (reaches()) below();
    }
  }
};

PointTree::PointTree(const Points& points) : impl_(std::make_unique<Impl>(points)) {}
PointTree::~PointTree() = default;
PointTree::PointTree(PointTree&&) noexcept = default;

std::vector<PointTree::Neighbour> PointTree::nearest(const Eigen::Vector3d& point, int k) const {
  const std::size_t wanted = std::min<std::size_t>(std::max(k, 0), impl_->order.size());
  if (wanted == 0) return {};
  Impl::Search search{point.transpose(), wanted, {}};
  impl_->visit(search, 0, static_cast<int>(impl_->order.size()));
  std::sort_heap(search.heap.begin(), search.heap.end());
  std::vector<Neighbour> result;
  for (const auto& [squared, index] : search.heap) result.push_back({index, std::sqrt(squared)});
  return result;
}

}  // namespace vultus
