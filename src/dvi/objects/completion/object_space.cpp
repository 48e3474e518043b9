#include "dvi/objects/completion/object_space.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "dvi/core/lazy.h"
#include "dvi/core/threads.h"
#include "dvi/objects/seconds.h"

namespace dvi::objects {
namespace {

struct ObjectSpaceParams {
  std::ptrdiff_t min_passes = 2;  ///< consecutive scans that pass an empty voxel; rays pass glass and edges at times
  /// Share of the scans in which masks show an object in a voxel, among those in which images show the voxel, between the first
  /// and the last of them, and in all. Labels often begin and end while an object is visible. Detectors miss objects, so that
  /// disputed scans count as those of an object between the first and the last one, but as background in all.
  double min_inner_share = 0.6, min_object_share = 0.2;
  int neighbor_voxels = 2;    ///< distance between voxels of one object
  std::size_t min_scans = 2;  ///< scans in which masks show an object
  double max_step_s = 0.3;    ///< time between voxels of one object that moves
  double cell_m = 10;         ///< edge of the squares in which voxels near a scan are searched
};
constexpr ObjectSpaceParams kSpace;

using VoxelKey = std::tuple<int, int, int>;

VoxelKey key_of(const Eigen::Vector3d& world) {
  const Eigen::Vector3i index = voxel_at(world);
  return {index.x(), index.y(), index.z()};
}

Eigen::Vector3i index_of(const VoxelKey& key) { return {std::get<0>(key), std::get<1>(key), std::get<2>(key)}; }

Eigen::Vector3d center_of(const Eigen::Vector3i& index) {
  return (index.cast<double>() + Eigen::Vector3d::Constant(0.5)) * kObjectVoxelM;
}

// What one scan shows of a voxel.
enum class VoxelState : std::uint8_t { free, object, disputed, background, unclear };

struct VoxelObservation {
  std::uint32_t scan;
  VoxelState state;
};

struct CandidateVoxel {
  VoxelKey key;
  std::vector<VoxelObservation> observations;  // in order of time

  // Adds an observation. Of consecutive scans that pass the voxel, only the first ones and the last one are kept: no more are
  // needed to find the periods in which it is occupied.
  void add(std::size_t scan, VoxelState state) {
    const VoxelObservation added{static_cast<std::uint32_t>(scan), state};
    const auto is_free = [](const VoxelObservation& observation) { return observation.state == VoxelState::free; };
    if (is_free(added) && std::ssize(observations) >= kSpace.min_passes &&
        std::all_of(observations.end() - kSpace.min_passes, observations.end(), is_free))
      observations.back() = added;
    else
      observations.push_back(added);
  }
};

// A voxel with returns of one scan, and what masks show of it.
struct VoxelVote {
  VoxelKey key;
  MaskVote vote;
};
using ScanVotes = std::vector<VoxelVote>;  // in order of keys

ScanVotes vote_on_voxels(const std::vector<CameraMaskEvidence>& cameras, const MovingReturns& returns, std::size_t scan) {
  const auto obstacles = returns.obstacles(scan);
  const std::vector<MaskVote> votes = vote_by_masks(cameras, *obstacles, returns.time_ns(scan));
  ScanVotes all;
  all.reserve(votes.size());
  for (std::size_t i = 0; i < votes.size(); ++i) all.push_back({key_of(obstacles->points[i]), votes[i]});
  std::sort(all.begin(), all.end(), [](const VoxelVote& a, const VoxelVote& b) { return a.key < b.key; });
  ScanVotes out;
  for (const VoxelVote& vote : all) {
    if (out.empty() || out.back().key != vote.key)
      out.push_back(vote);
    else
      out.back().vote = std::max(out.back().vote, vote.vote);
  }
  out.shrink_to_fit();
  return out;
}

// Finds the voxels in which masks show an object at any time, in order of keys.
std::vector<CandidateVoxel> find_candidates(const Lazy<ScanVotes>& votes, const Tick& tick) {
  std::set<VoxelKey> found;
  for_blocks(votes.size(), [&](std::size_t first, std::size_t last) {
    std::vector<std::shared_ptr<const ScanVotes>> scans(last - first);
    parallel_for(scans.size(), [&](std::size_t i) { scans[i] = votes[first + i]; });
    for (const auto& scan : scans) {
      for (const auto& [key, vote] : *scan)
        if (vote >= MaskVote::disputed) found.insert(key);
      tick();
    }
  });
  std::vector<CandidateVoxel> out;
  out.reserve(found.size());
  for (const VoxelKey& key : found) out.push_back({key, {}});
  return out;
}

VoxelState to_state(MaskVote vote) {
  return vote == MaskVote::object       ? VoxelState::object
         : vote == MaskVote::disputed   ? VoxelState::disputed
         : vote == MaskVote::background ? VoxelState::background
                                        : VoxelState::unclear;
}

// Collects the observations of candidates, scan by scan. A scan concerns the candidates near its sensor only, so the time per
// scan does not grow with the drive.
class Observations {
 public:
  Observations(const MovingReturns& returns, std::vector<CandidateVoxel>& voxels) : returns_(returns), voxels_(voxels) {
    for (std::size_t i = 0; i < voxels.size(); ++i) cells_[cell_of(center_of(index_of(voxels[i].key)).head<2>())].push_back(i);
  }

  void add(std::size_t scan, const ScanVotes& hit) {
    if (!returns_.is_trusted(scan)) return;
    for (const auto& [key, vote] : hit)
      if (CandidateVoxel* const voxel = find(key)) voxel->add(scan, to_state(vote));
    const auto space = returns_.free_space(scan);
    if (!space->valid()) return;
    const std::vector<std::size_t> near = find_near(scan);
    parallel_for(near.size(), [&](std::size_t i) {
      CandidateVoxel& voxel = voxels_[near[i]];
      if (!voxel.observations.empty() && voxel.observations.back().scan == scan) return;  // hit
      const Eigen::Vector3d center = center_of(index_of(voxel.key));
      if (returns_.can_observe(scan, center.head<2>()) && space->judge(center, kJudgedRadiusM) == FreeSpace::Seen::passed)
        voxel.add(scan, VoxelState::free);
    });
  }

 private:
  using Cell = std::pair<int, int>;

  static Cell cell_of(const Eigen::Vector2d& position) {
    const Eigen::Vector2i cell = (position / kSpace.cell_m).array().floor().cast<int>();
    return {cell.x(), cell.y()};
  }

  CandidateVoxel* find(const VoxelKey& key) {
    const auto found = std::lower_bound(voxels_.begin(), voxels_.end(), key,
                                        [](const CandidateVoxel& voxel, const VoxelKey& k) { return voxel.key < k; });
    return found != voxels_.end() && found->key == key ? &*found : nullptr;
  }

  // Returns the candidates in the cells that the scan may observe.
  std::vector<std::size_t> find_near(std::size_t scan) const {
    const Eigen::AlignedBox2d area = returns_.observable_area(scan);
    const Cell low = cell_of(area.min()), high = cell_of(area.max());
    std::vector<std::size_t> out;
    for (int x = low.first; x <= high.first; ++x) {
      const auto end = cells_.upper_bound({x, high.second});
      for (auto cell = cells_.lower_bound({x, low.second}); cell != end; ++cell)
        out.insert(out.end(), cell->second.begin(), cell->second.end());
    }
    return out;
  }

  const MovingReturns& returns_;
  std::vector<CandidateVoxel>& voxels_;
  std::map<Cell, std::vector<std::size_t>> cells_;  // candidates, seen from above
};

void observe(const Lazy<ScanVotes>& votes, const MovingReturns& returns, std::vector<CandidateVoxel>& voxels) {
  Observations observations(returns, voxels);
  for_blocks(votes.size(), [&](std::size_t first, std::size_t last) {
    std::vector<std::shared_ptr<const ScanVotes>> scans(last - first);
    parallel_for(scans.size(), [&](std::size_t i) { scans[i] = votes[first + i]; });
    for (std::size_t i = 0; i < scans.size(); ++i) observations.add(first + i, *scans[i]);
  });
}

// Divides the observations of a voxel into the periods between those in which it is free, and returns the periods in which an
// object occupied it.
class Periods {
 public:
  Periods(const CandidateVoxel& voxel, const MovingReturns& returns) : voxel_(voxel), returns_(returns) {}

  std::vector<OccupiedVoxel> find() {
    begin(std::numeric_limits<std::int64_t>::min());
    const auto& all = voxel_.observations;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].state != VoxelState::free) {
        add_return(all[i]);
        continue;
      }
      std::size_t end = i;
      while (end < all.size() && all[end].state == VoxelState::free) ++end;
      const bool is_clear = static_cast<std::ptrdiff_t>(end - i) >= kSpace.min_passes || end == all.size() || i == 0;
      if (is_clear) {
        finish(returns_.time_ns(all[i].scan));
        begin(returns_.time_ns(all[end - 1].scan));
      }
      i = end - 1;
    }
    finish(std::numeric_limits<std::int64_t>::max());
    return std::move(out_);
  }

 private:
  void begin(std::int64_t free_until_ns) {
    period_ = {index_of(voxel_.key), free_until_ns, 0, 0, 0, {}, {}, -1};
    background_.clear();
  }

  void add_return(const VoxelObservation& observation) {
    const std::int64_t time = returns_.time_ns(observation.scan);
    if (period_.returns.empty()) period_.first_return_ns = time;
    period_.last_return_ns = time;
    period_.returns.push_back(observation.scan);
    if (observation.state == VoxelState::object || observation.state == VoxelState::disputed)
      period_.evidence.push_back(observation.scan);
    if (observation.state == VoxelState::background) background_.push_back(observation.scan);
  }

  // Counts the scans that show background, from one scan to another, both included.
  double count_background(std::size_t first, std::size_t last) const {
    return static_cast<double>(
        std::count_if(background_.begin(), background_.end(), [&](std::size_t scan) { return scan >= first && scan <= last; }));
  }

  bool is_object() const {
    if (period_.evidence.empty()) return false;
    const auto object = static_cast<double>(period_.evidence.size()), background = static_cast<double>(background_.size());
    const double inner = count_background(period_.evidence.front(), period_.evidence.back());
    return object >= kSpace.min_object_share * (object + background) && object >= kSpace.min_inner_share * (object + inner);
  }

  void finish(std::int64_t free_from_ns) {
    if (!is_object()) return;
    period_.last_ns = free_from_ns;
    out_.push_back(period_);
  }

  const CandidateVoxel& voxel_;
  const MovingReturns& returns_;
  OccupiedVoxel period_;
  std::vector<std::size_t> background_;  // scans of the period
  std::vector<OccupiedVoxel> out_;
};

// Joins voxels to objects.
class ObjectUnion {
 public:
  explicit ObjectUnion(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }

  std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) {
    a = find(a), b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

bool are_at_the_same_time(const OccupiedVoxel& a, const OccupiedVoxel& b) {
  return seconds_between(a.last_return_ns, b.first_return_ns) <= kSpace.max_step_s &&
         seconds_between(b.last_return_ns, a.first_return_ns) <= kSpace.max_step_s;
}

// Numbers the objects in order of their first voxels, and removes those that too few scans show.
void number_objects(std::vector<OccupiedVoxel>& voxels) {
  std::map<std::pair<int, int>, std::vector<std::size_t>> columns;
  for (std::size_t i = 0; i < voxels.size(); ++i) columns[{voxels[i].index.x(), voxels[i].index.y()}].push_back(i);
  ObjectUnion objects(voxels.size());
  const int radius = kSpace.neighbor_voxels;
  for (const auto& [column, members] : columns)
    for (int dy = -radius; dy <= radius; ++dy)
      for (int dx = 0; dx <= radius; ++dx) {
        const auto other = columns.find({column.first + dx, column.second + dy});
        if (other == columns.end()) continue;
        for (const std::size_t a : members)
          for (const std::size_t b : other->second)
            if (a != b && are_at_the_same_time(voxels[a], voxels[b])) objects.join(a, b);
      }
  std::map<std::size_t, std::set<std::size_t>> scans;
  for (std::size_t i = 0; i < voxels.size(); ++i)
    scans[objects.find(i)].insert(voxels[i].evidence.begin(), voxels[i].evidence.end());
  std::map<std::size_t, int> number;
  for (const auto& [root, evidence] : scans)
    if (evidence.size() >= kSpace.min_scans) number.emplace(root, static_cast<int>(number.size()));
  for (std::size_t i = 0; i < voxels.size(); ++i)
    if (const auto found = number.find(objects.find(i)); found != number.end()) voxels[i].object = found->second;
  std::erase_if(voxels, [](const OccupiedVoxel& voxel) { return voxel.object < 0; });
}

// Removes voxels of static surfaces that wrong masks cover in few scans, or that the loose masks of one camera cover and those
// of another do not. Rays miss a voxel in most scans if they are far apart, so the masks are compared with the scans that show
// background in the voxel or its neighbors while it is occupied.
void remove_background(std::vector<OccupiedVoxel>& voxels, const std::vector<CandidateVoxel>& candidates,
                       const MovingReturns& returns) {
  std::map<VoxelKey, const CandidateVoxel*> by_key;
  for (const CandidateVoxel& candidate : candidates) by_key.emplace(candidate.key, &candidate);
  std::vector<char> is_background(voxels.size());
  parallel_for(voxels.size(), [&](std::size_t i) {
    const OccupiedVoxel& voxel = voxels[i];
    std::set<std::size_t> object, background;
    const int radius = kSpace.neighbor_voxels;
    for (int dx = -radius; dx <= radius; ++dx)
      for (int dy = -radius; dy <= radius; ++dy)
        for (int dz = -radius; dz <= radius; ++dz) {
          const auto found = by_key.find({voxel.index.x() + dx, voxel.index.y() + dy, voxel.index.z() + dz});
          if (found == by_key.end()) continue;
          for (const VoxelObservation& observation : found->second->observations) {
            const std::int64_t time = returns.time_ns(observation.scan);
            if (time <= voxel.first_ns || time >= voxel.last_ns) continue;
            if (observation.state == VoxelState::object) object.insert(observation.scan);
            if (observation.state == VoxelState::background || observation.state == VoxelState::disputed)
              background.insert(observation.scan);
          }
        }
    for (const std::size_t scan : object) background.erase(scan);
    const auto masked = static_cast<double>(object.size()), unmasked = static_cast<double>(background.size());
    is_background[i] = masked < kSpace.min_object_share * (masked + unmasked);
  });
  std::size_t i = 0;
  std::erase_if(voxels, [&](const OccupiedVoxel&) { return is_background[i++] != 0; });
}

}  // namespace

Eigen::Vector3d OccupiedVoxel::center() const { return center_of(index); }

std::vector<OccupiedVoxel> find_object_space(const std::vector<CameraMaskEvidence>& cameras, const MovingReturns& returns,
                                             const Tick& tick) {
  // Kept for the second pass as far as memory allows.
  const Lazy<ScanVotes> votes(returns.scans(), [&](std::size_t scan) { return vote_on_voxels(cameras, returns, scan); });
  std::vector<CandidateVoxel> candidates = find_candidates(votes, tick);
  observe(votes, returns, candidates);
  std::vector<OccupiedVoxel> out;
  for (const CandidateVoxel& voxel : candidates)
    for (OccupiedVoxel& period : Periods(voxel, returns).find()) out.push_back(std::move(period));
  remove_background(out, candidates, returns);
  number_objects(out);
  return out;
}

}  // namespace dvi::objects
