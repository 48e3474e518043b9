#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

#include <Eigen/Core>

namespace dvi::objects {

/// One return of a cluster.
struct ClusterReturn {
  Eigen::Vector3d point;     ///< meters, world axes
  std::int64_t time_ns = 0;  ///< time of the measurement
  double ground = 0;         ///< height of the ground below, meters, world axes
  double ray_spacing_m = 0;  ///< distance to the next ray above
};

/// The returns of a cluster, in 24 bytes each, because the objects of a whole drive are in memory at a time. Positions and the
/// ground are rounded to multiples of 2^-16 m (15 micrometers) and times to multiples of 100 ns, in world axes, so that a
/// return is equal in all clusters that contain it. All returns are within 32 km and 200 s of the first one.
class ClusterReturns {
 public:
  /// Reads the returns in order, for range-based loops.
  class Iterator {
   public:
    // NOLINTBEGIN(readability-identifier-naming): names of the standard library
    using iterator_category = std::input_iterator_tag;
    using value_type = ClusterReturn;
    using difference_type = std::ptrdiff_t;
    using pointer = void;
    using reference = ClusterReturn;
    // NOLINTEND(readability-identifier-naming)

    Iterator(const ClusterReturns& of, std::size_t at) : of_(&of), at_(at) {}
    ClusterReturn operator*() const { return (*of_)[at_]; }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    Iterator operator++(int) {
      Iterator before = *this;
      ++at_;
      return before;
    }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }

   private:
    const ClusterReturns* of_;
    std::size_t at_;
  };

  void push_back(const ClusterReturn& added);
  ClusterReturn operator[](std::size_t i) const;
  ClusterReturn front() const { return (*this)[0]; }
  std::size_t size() const { return returns_.size(); }
  bool empty() const { return returns_.empty(); }
  Iterator begin() const { return {*this, 0}; }
  Iterator end() const { return {*this, size()}; }
  /// Frees memory that no return uses.
  void shrink_to_fit() { returns_.shrink_to_fit(); }

  /// Return the medians over all returns. There must be at least one.
  double median_ground() const;
  double median_ray_spacing_m() const;

 private:
  // Steps of the position, of the height of the ground, and of the time, relative to the first return.
  struct Packed {
    std::array<std::int32_t, 3> point;
    std::int32_t ground;
    std::int32_t time;
    float ray_spacing_m;
  };

  std::array<std::int64_t, 3> origin_{};  // position of the first return, in steps
  std::int64_t origin_time_ = 0;          // its time, in steps
  std::vector<Packed> returns_;
};

}  // namespace dvi::objects
