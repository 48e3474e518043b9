#include "dvi/media/bin_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Core>

#include "dvi/core/error.h"
#include "dvi/core/median.h"
#include "dvi/core/text.h"

namespace dvi::media {
namespace {

constexpr std::size_t kMinColumns = 3, kMaxColumns = 12;
constexpr const char* kStateColumns =
    R"(state them in dvi.toml, such as [lidar] columns = ["x", "y", "z", "intensity", "ring"])";

// Numbers from three blocks of a file, each with its index among all numbers.
struct NumberSample {
  std::vector<double> numbers;
  std::vector<std::size_t> places;  // index among all numbers of the file
};

NumberSample sample_numbers(std::string_view bytes, std::size_t scalar_bytes) {
  constexpr std::size_t kBlockNumbers = 2520;
  const std::size_t count = bytes.size() / scalar_bytes;
  NumberSample sample;
  std::size_t next = 0;
  for (const std::size_t start : {std::size_t{0}, count / 2, count - std::min(count, kBlockNumbers)})
    for (next = std::max(next, start); next < std::min(count, start + kBlockNumbers); ++next) {
      const double number = load_scalar(bytes.data() + next * scalar_bytes, scalar_bytes);
      sample.numbers.push_back(std::isfinite(number) ? number : 0);  // points that were not measured
      sample.places.push_back(next);
    }
  return sample;
}

// Returns ranks from -1 to 1; equal values have equal ranks.
std::vector<double> compute_centered_ranks(const std::vector<double>& values) {
  std::vector<std::pair<double, std::size_t>> sorted;  // with indices
  sorted.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) sorted.emplace_back(values[i], i);
  std::sort(sorted.begin(), sorted.end());
  std::vector<double> ranks(values.size());
  for (std::size_t first = 0; first < sorted.size();) {
    std::size_t end = first;
    while (end < sorted.size() && sorted[end].first == sorted[first].first) ++end;
    const double rank = static_cast<double>(first + end) / static_cast<double>(sorted.size()) - 1;
    for (; first < end; ++first) ranks[sorted[first].second] = rank;
  }
  return ranks;
}

// Returns the share of the variance of ranks that lies between columns.
double compute_variance_between(const std::vector<double>& ranks, const std::vector<std::size_t>& places, std::size_t columns) {
  std::vector<double> sums(columns), counts(columns);
  double total = 0;
  for (std::size_t i = 0; i < ranks.size(); ++i) {
    const std::size_t column = places[i] % columns;
    sums[column] += ranks[i], counts[column] += 1;
    total += ranks[i] * ranks[i];
  }
  double between = 0;
  for (std::size_t c = 0; c < columns; ++c)
    if (counts[c] > 0) between += sums[c] * sums[c] / counts[c];
  return total > 0 ? between / total : 0;
}

// Returns the Kolmogorov-Smirnov distance: the largest distance between two cumulative distributions.
double compute_distribution_distance(std::vector<double> a, std::vector<double> b) {
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  double largest = 0;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const double value = std::min(a[i], b[j]);
    while (i < a.size() && a[i] == value) ++i;
    while (j < b.size() && b[j] == value) ++j;
    largest = std::max(largest, std::abs(static_cast<double>(i) / static_cast<double>(a.size()) -
                                         static_cast<double>(j) / static_cast<double>(b.size())));
  }
  return largest;
}

// Returns whether the points at two positions within rows lie in the same direction, like those of two beams or returns that
// were measured at the same time. The scan may cover only a part of a revolution.
bool share_azimuth(const std::vector<std::vector<double>>& values, std::size_t shift) {
  constexpr double kMinExcess = 0.5;
  Eigen::Vector2d first = Eigen::Vector2d::Zero(), second = first, between = first;
  const std::size_t rows = values.back().size();
  for (std::size_t row = 0; row < rows; ++row) {
    const double a = std::atan2(values[1][row], values[0][row]), b = std::atan2(values[1 + shift][row], values[shift][row]);
    first += Eigen::Vector2d(std::cos(a), std::sin(a)), second += Eigen::Vector2d(std::cos(b), std::sin(b));
    between += Eigen::Vector2d(std::cos(a - b), std::sin(a - b));
  }
  const auto count = static_cast<double>(rows);
  const double by_chance = first.norm() * second.norm() / (count * count);
  return between.norm() / count - by_chance >= kMinExcess * (1 - by_chance);
}

bool share_distribution(const std::vector<std::vector<double>>& values, std::size_t shift) {
  constexpr double kMaxMeanDistance = 0.3;
  double sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) sum += compute_distribution_distance(values[axis], values[axis + shift]);
  return sum / 3 <= kMaxMeanDistance;
}

// Returns whether rows of `columns` numbers are several points of `fewer` numbers: x, y and z then repeat within the rows.
bool is_repeating(const NumberSample& sample, std::size_t columns, std::size_t fewer) {
  std::vector<std::vector<double>> values(columns);
  for (std::size_t i = 0; i + columns <= sample.numbers.size(); ++i)
    if (sample.places[i] % columns == 0 && sample.places[i + columns - 1] == sample.places[i] + columns - 1)  // a whole row
      for (std::size_t c = 0; c < columns; ++c) values[c].push_back(sample.numbers[i + c]);
  for (std::size_t shift = fewer; shift < columns; shift += fewer)
    if (!share_distribution(values, shift) && !share_azimuth(values, shift)) return false;
  return true;
}

std::optional<std::size_t> infer_column_count(std::string_view bytes, std::size_t scalar_bytes) {
  constexpr std::size_t kMinNumbers = 600;
  constexpr double kMinVarianceBetween = 0.2, kMinRelativeVariance = 0.97;
  const NumberSample sample = sample_numbers(bytes, scalar_bytes);
  if (sample.numbers.size() < kMinNumbers) return std::nullopt;
  std::vector<double> magnitudes;
  for (const double number : sample.numbers) magnitudes.push_back(std::abs(number));
  const std::vector<double> ranks = compute_centered_ranks(sample.numbers),
                            magnitude_ranks = compute_centered_ranks(magnitudes);
  std::array<double, kMaxColumns + 1> between{};
  for (std::size_t columns = kMinColumns; columns <= kMaxColumns; ++columns)
    between[columns] = compute_variance_between(ranks, sample.places, columns) +
                       compute_variance_between(magnitude_ranks, sample.places, columns);
  const double best = *std::max_element(between.begin(), between.end());
  if (best < kMinVarianceBetween) return std::nullopt;
  std::size_t columns = kMinColumns;
  while (between[columns] < kMinRelativeVariance * best) ++columns;
  for (std::size_t fewer = kMinColumns; fewer < columns; ++fewer)
    if (columns % fewer == 0 && is_repeating(sample, columns, fewer)) return fewer;
  return columns;
}

bool is_plausible(double number) { return std::abs(number) >= 1e-4 && std::abs(number) <= 1e4; }

// The first half of an 8-byte number is the end of its mantissa, which is zero or random.
bool holds_float64(std::string_view bytes) {
  constexpr double kMinPlausible = 0.7, kMaxPlausibleHalves = 0.4;
  const NumberSample sample = sample_numbers(bytes, 8);
  double count = 0, plausible = 0, halves = 0;
  for (std::size_t i = 0; i < sample.numbers.size(); ++i) {
    if (sample.numbers[i] == 0) continue;
    count += 1;
    if (is_plausible(sample.numbers[i])) plausible += 1;
    if (is_plausible(load_scalar(bytes.data() + sample.places[i] * 8, 4))) halves += 1;
  }
  return count > 0 && plausible >= kMinPlausible * count && halves <= kMaxPlausibleHalves * count;
}

// The columns of a file after x, y and z, and the values that they are compared with.
struct BinColumns {
  std::vector<std::vector<double>> values;  // by column
  std::vector<Eigen::Vector3f> points;
  std::vector<double> azimuth, elevation, range;  // by point
};

BinColumns load_columns(std::string_view bytes, const BinShape& shape) {
  BinColumns out;
  out.values.resize(shape.columns);
  for (std::size_t at = 0; at + shape.point_bytes() <= bytes.size(); at += shape.point_bytes()) {
    std::array<double, kMaxColumns> row{};
    for (std::size_t c = 0; c < shape.columns; ++c)
      row[c] = load_scalar(bytes.data() + at + c * shape.scalar_bytes, shape.scalar_bytes);
    if (!std::isfinite(row[0] + row[1] + row[2]) || (row[0] == 0 && row[1] == 0)) continue;
    for (std::size_t c = 0; c < shape.columns; ++c) out.values[c].push_back(row[c]);
    out.points.emplace_back(Eigen::Vector3d(row[0], row[1], row[2]).cast<float>());
    out.azimuth.push_back(std::atan2(row[1], row[0]));
    out.range.push_back(std::hypot(row[0], row[1]));
    out.elevation.push_back(std::atan2(row[2], out.range.back()));
  }
  return out;
}

// Rings are small whole numbers, each with one elevation. Near returns, including those of the vehicle itself, are ignored,
// because rays do not begin at one point.
bool is_ring(const std::vector<double>& values, const BinColumns& columns) {
  constexpr std::size_t kMinRings = 4, kMaxRings = 256;
  constexpr double kMaxVarianceWithin = 0.1;
  struct Sums {
    double count = 0, sum = 0, squares = 0;
    double variance() const { return squares - sum * sum / count; }
  };
  const double min_range = median(columns.range);
  std::map<double, Sums> rings;
  Sums all;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] >= 0) || values[i] != std::floor(values[i])) return false;
    if (columns.range[i] < min_range) continue;
    const double elevation = columns.elevation[i];
    for (Sums* sums : {&rings[values[i]], &all})
      sums->count += 1, sums->sum += elevation, sums->squares += elevation * elevation;
    if (rings.size() > kMaxRings) return false;
  }
  double within = 0;
  for (const auto& [ring, sums] : rings) within += sums.variance();
  return rings.size() >= kMinRings && within <= kMaxVarianceWithin * all.variance();
}

// Returns whether values increase with the order of the points, or points with equal times have equal azimuths.
bool follows_scan(const std::vector<double>& times, const std::vector<double>& azimuth) {
  constexpr double kMinGrowing = 0.99, kMaxVarianceWithin = 0.1;
  constexpr std::size_t kBins = 24;
  std::size_t growing = 0;
  for (std::size_t i = 1; i < times.size(); ++i) growing += times[i] >= times[i - 1] ? 1 : 0;
  if (static_cast<double>(growing) >= kMinGrowing * static_cast<double>(times.size() - 1)) return true;
  const auto [first, last] = std::minmax_element(times.begin(), times.end());
  std::array<Eigen::Vector2d, kBins> directions;
  directions.fill(Eigen::Vector2d::Zero());
  Eigen::Vector2d all = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < times.size(); ++i) {
    const auto bin = std::min(static_cast<std::size_t>(kBins * (times[i] - *first) / (*last - *first)), kBins - 1);
    const Eigen::Vector2d direction(std::cos(azimuth[i]), std::sin(azimuth[i]));
    directions[bin] += direction, all += direction;
  }
  double concentrated = 0;
  for (const Eigen::Vector2d& sum : directions) concentrated += sum.norm();
  const auto count = static_cast<double>(times.size());
  return count - concentrated <= kMaxVarianceWithin * (count - all.norm());
}

bool is_time(const std::vector<double>& values, const BinColumns& columns, const TimedScan& scan) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); }) &&
         infer_point_times(values, scan).use == PointTimes::Use::times && follows_scan(values, columns.azimuth);
}

std::vector<std::string> name_columns(std::string_view bytes, const BinShape& shape, const TimedScan& scan) {
  std::vector<std::string> names = {"x", "y", "z"};
  if (shape.columns == 4) names.emplace_back("intensity");
  if (shape.columns <= 4) return names;
  const BinColumns columns = load_columns(bytes, shape);
  TimedScan cropped = scan;
  cropped.turn_share = compute_turn_share(columns.points);
  const auto is_new = [&](const char* name) { return std::find(names.begin(), names.end(), name) == names.end(); };
  for (std::size_t c = 3; c < shape.columns; ++c) {
    const std::vector<double>& values = columns.values[c];
    const bool is_constant = std::all_of(values.begin(), values.end(), [&](double value) { return value == values.front(); });
    if (is_constant)
      names.emplace_back("_");
    else if (is_new("ring") && is_ring(values, columns))
      names.emplace_back("ring");
    else if (is_new("t") && is_time(values, columns, cropped))
      names.emplace_back("t");
    else
      names.emplace_back(is_new("intensity") ? "intensity" : "_");
  }
  return names;
}

// Returns the default shape, which all files must match if their values do not determine the shape.
BinShape find_default_shape(const std::vector<fs::path>& files) {
  const BinShape usual;
  for (const fs::path& file : files)
    if (const std::uintmax_t bytes = fs::file_size(file); bytes % usual.point_bytes() != 0)
      throw InputError(file,
                       fmt::format("{} bytes are not a whole number of points of 16 bytes (float32 x y z intensity), and "
                                   "its columns cannot be inferred",
                                   bytes),
                       kStateColumns);
  return usual;
}

}  // namespace

bool is_bin(const fs::path& file) { return to_lower_case(file.extension().string()) == ".bin"; }

double load_scalar(const char* at, std::size_t scalar_bytes) {
  if (scalar_bytes == 8) {
    double value = 0;
    std::memcpy(&value, at, sizeof value);
    return value;
  }
  float value = 0;
  std::memcpy(&value, at, sizeof value);
  return static_cast<double>(value);
}

std::string to_text(const BinShape& shape) {
  return fmt::format("{} columns of float{}", shape.columns, 8 * shape.scalar_bytes);
}

std::string BinLayout::text() const { return fmt::format("{}: {}", to_text(shape()), fmt::join(columns, " ")); }

std::optional<BinShape> infer_bin_shape(std::string_view bytes) {
  const std::size_t scalar_bytes = holds_float64(bytes) ? 8 : 4;
  if (const auto columns = infer_column_count(bytes, scalar_bytes)) return BinShape{scalar_bytes, *columns};
  return std::nullopt;
}

BinLayout infer_bin_layout(const std::vector<fs::path>& files, const TimedScan& scan) {
  std::optional<BinShape> shape;
  fs::path example;
  if (files.empty()) return {};
  std::vector<fs::path> sampled = {files.front(), files[files.size() / 2], files.back()};
  for (const fs::path& file : sampled) {
    const auto found = infer_bin_shape(read_file(file));
    if (found && shape && *found != *shape)
      throw InputError(file,
                       fmt::format("has {}, but {} has {}", to_text(*found), example.filename().string(), to_text(*shape)),
                       "write all scans with the same columns");
    if (found) shape = found, example = file;
  }
  if (!shape) shape = find_default_shape(sampled);
  constexpr std::size_t kMaxUsualColumns = 8;
  if (shape->columns > kMaxUsualColumns)  // more columns suggest numbers of different sizes
    throw InputError(example, fmt::format("looks like {}, which is unusual for scans", to_text(*shape)), kStateColumns);
  return {shape->scalar_bytes, name_columns(read_file(files.back()), *shape, scan)};
}

BinLayout use_stated_layout(const std::vector<fs::path>& files, const std::vector<std::string>& columns) {
  BinLayout layout{.columns = columns, .stated = true};
  if (files.empty()) return layout;
  if (holds_float64(read_file(files.back()))) layout.scalar_bytes = 8;
  for (const fs::path& file : files)
    if (const std::uintmax_t bytes = fs::file_size(file); bytes % layout.shape().point_bytes() != 0)
      throw InputError(file,
                       fmt::format("{} bytes are not a whole number of points of {} bytes ({})", bytes,
                                   layout.shape().point_bytes(), layout.text()),
                       "correct [lidar] columns in dvi.toml");
  return layout;
}

}  // namespace dvi::media
