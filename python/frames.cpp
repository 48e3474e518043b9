#include "frames.h"

#include <utility>

#include <opencv2/imgproc.hpp>

#include "dvi/core/error.h"
#include "dvi/core/frame_name.h"
#include "dvi/core/threads.h"
#include "dvi/depth/depth_map.h"
#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"
#include "dvi/run/run.h"

namespace dvi::python {
namespace py = pybind11;

namespace {

py::dtype dtype_of(int depth) {
  switch (depth) {
    case CV_8U:
      return py::dtype::of<std::uint8_t>();
    case CV_16U:
      return py::dtype::of<std::uint16_t>();
    default:
      return py::dtype::of<float>();
  }
}

cv::Mat to_rgb(const cv::Mat& bgr) {
  cv::Mat rgb;
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  return rgb;
}

Frame to_frame(const std::string& name, std::size_t number, const harmonize::FilledFrame& filled) {
  cv::Mat color;
  filled.color.convertTo(color, CV_8U);
  cv::Mat depth = filled.depth.clone();
  depth.setTo(depth::DepthMap::kUnknown, filled.depth >= depth::DepthMap::kInfinity);
  return {camera_of_frame(name), image_of_frame(name), number, to_rgb(color), filled.mask, filled.kind,
          filled.provenance,     filled.confidence,    depth};
}

}  // namespace

py::array to_array(const cv::Mat& mat) {
  auto owner = std::make_unique<cv::Mat>(mat);
  const auto rows = static_cast<py::ssize_t>(mat.rows), cols = static_cast<py::ssize_t>(mat.cols);
  std::vector<py::ssize_t> shape{rows, cols},
      strides{static_cast<py::ssize_t>(mat.step[0]), static_cast<py::ssize_t>(mat.elemSize())};
  if (mat.channels() > 1) shape.push_back(mat.channels()), strides.push_back(static_cast<py::ssize_t>(mat.elemSize1()));
  const void* data = mat.data;
  const py::capsule keep(owner.release(), [](void* matrix) { delete static_cast<cv::Mat*>(matrix); });
  return py::array(dtype_of(mat.depth()), shape, strides, data, keep);
}

Run::Run(dvi::job::Job job, int threads, Task::Callback progress)
    : job_(std::move(job)), progress_(std::move(progress)), task_(threads, [this](Progress& p) { make(p); }) {
  task_.start();
}

void Run::make(Progress& progress) {
  const auto begin = [this](const dvi::run::FramesToFill& frames) {
    const std::lock_guard lock(task_.mutex);
    names_ = frames.names;
    order_ = frames.order;
    // The last frame of a camera is finished together with the one before it.
    max_made_ = static_cast<std::size_t>(thread_count()) + list_cameras(names_).size();
    missing_.assign(names_.size(), false);
    for (const std::size_t i : frames.missing) missing_[i] = true;
  };
  const auto finished = [this](std::size_t number, const harmonize::FilledFrame& frame) { push(number, frame); };
  const dvi::result::RunReport report = dvi::run::run(job_, progress, {.begin = begin, .finished = finished});
  const std::lock_guard lock(task_.mutex);
  report_ = dvi::result::to_json(report);
  if (!names_.empty()) return;
  names_ = report.frame_names();  // the result was there already
  order_ = report.frame_order();
  missing_.assign(names_.size(), false);
}

void Run::push(std::size_t number, const harmonize::FilledFrame& filled) {
  auto frame = std::make_shared<const Frame>(to_frame(names_[number], number, filled));
  std::unique_lock lock(task_.mutex);
  // A frame that is next always fits: others may wait for it.
  task_.changed.wait(lock, [&] { return task_.canceled || drained_ || number == order_[next_] || made_.size() < max_made_; });
  if (task_.canceled) throw Interrupted();
  if (!drained_) made_[number] = std::move(frame);
  task_.changed.notify_all();
}

Frame Run::read(std::size_t number) const {
  const std::string& name = names_[number];
  const fs::path out = job_.out;
  const cv::Size size = dvi::media::image_size(out / picture_file("frames", name));
  cv::Mat depth;
  dvi::media::read_png_depth(out / picture_file("depth", name), size).convertTo(depth, CV_32F, 1.0 / 256);
  return {camera_of_frame(name),
          image_of_frame(name),
          number,
          to_rgb(dvi::media::read_image(out / picture_file("frames", name), size)),
          dvi::media::read_png_gray(out / picture_file("masks", name), size),
          dvi::media::read_png_gray(out / picture_file("kind", name), size),
          dvi::media::read_png_triples(out / picture_file("provenance", name), size),
          dvi::media::read_png_gray(out / picture_file("confidence", name), size),
          depth};
}

std::shared_ptr<const Frame> Run::next() {
  const auto ready = [this] { return next_ < order_.size() && (!missing_[order_[next_]] || made_.contains(order_[next_])); };
  task_.wait(progress_, ready);
  std::shared_ptr<const Frame> frame;
  bool read_it = false;
  {
    const std::lock_guard lock(task_.mutex);
    if (const auto made = made_.find(next_ < order_.size() ? order_[next_] : order_.size()); made != made_.end()) {
      frame = std::move(made->second);
      made_.erase(made);
    } else {
      read_it = ready();
    }
    if (frame || read_it) ++next_;
    task_.changed.notify_all();
  }
  if (read_it) return std::make_shared<const Frame>(read(order_[next_ - 1]));
  if (!frame) task_.finish(progress_);
  return frame;
}

void Run::finish() {
  {
    const std::lock_guard lock(task_.mutex);
    drained_ = true;
    made_.clear();
    task_.changed.notify_all();
  }
  task_.finish(progress_);
}

}  // namespace dvi::python
