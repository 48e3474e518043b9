#include <unistd.h>

#include <benchmark/benchmark.h>

#include "dvi/core/random.h"
#include "dvi/media/image_file.h"
#include "dvi/media/point_cloud.h"
#include "dvi/media/write_image.h"
#include "dvi/testing/flat_scene.h"

namespace dvi::media {
namespace {

/// A temporary folder. Its files stay in the system's cache, so that decoding is measured.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("dvi_media_bench" + std::to_string(getpid()));
  Folder() { make_folder(path); }
  ~Folder() { fs::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
};

/// Makes an image of 1280x720 with some noise, which makes PNG slow.
cv::Mat3b noisy_picture() {
  cv::Mat3b image = waves(1280, 720, 1, 10);
  Random random(3);
  for (cv::Vec3b& v : image)
    for (int c = 0; c < 3; ++c) v[c] = cv::saturate_cast<uchar>(v[c] + 3 * random.normal());
  return image;
}

void read_picture(benchmark::State& state) {
  const Folder folder;
  write_png(folder.path / "a.png", noisy_picture());
  for (auto _ : state) benchmark::DoNotOptimize(read_image(folder.path / "a.png", {1280, 720}));
}
BENCHMARK(read_picture)->Unit(benchmark::kMillisecond);

void write_picture(benchmark::State& state) {
  const Folder folder;
  const cv::Mat3b image = noisy_picture();
  for (auto _ : state) write_png(folder.path / "a.png", image);
  state.counters["bytes"] = static_cast<double>(fs::file_size(folder.path / "a.png"));
}
BENCHMARK(write_picture)->Unit(benchmark::kMillisecond);

/// Reads a scan of 120,000 points in KITTI's format.
void read_scan(benchmark::State& state) {
  const Folder folder;
  Random random(4);
  std::vector<float> numbers;
  for (int i = 0; i < 480'000; ++i) numbers.push_back(static_cast<float>(random.uniform(-50, 50)));
  write_file(folder.path / "a.bin", {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float)});
  std::size_t points = 0;
  for (auto _ : state) points = read_point_cloud(folder.path / "a.bin").points.size();
  state.counters["points"] = static_cast<double>(points);
}
BENCHMARK(read_scan)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace dvi::media
