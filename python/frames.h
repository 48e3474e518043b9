#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <pybind11/numpy.h>

#include "dvi/core/files.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/job/job.h"
#include "task.h"

namespace dvi::python {

/// The matrix as a numpy array, which keeps it alive; nothing is copied.
pybind11::array to_array(const cv::Mat& mat);

/// A finished frame as Python has it: like the files of a result, but colors in the order R, G, B and depth in meters.
struct Frame {
  std::string camera;  ///< empty if the run cleans one camera
  std::string name;
  std::size_t index = 0;
  cv::Mat image, mask, kind, provenance, confidence, depth;
};

/// The frames of a run in order of time, as they are made. Frames that were finished before are read from OUT.
class Run {
 public:
  Run(dvi::job::Job job, int threads, Task::Callback progress);

  /// The next one; none at the end, where report() is known.
  std::shared_ptr<const Frame> next();
  /// Runs to the end without handing out frames.
  void finish();
  /// report.json; empty before the end.
  const std::string& report() const { return report_; }
  const std::string& out() const { return job_.out; }
  /// Stops the run at its next step and waits for that. The last call.
  void close() { task_.cancel(); }

 private:
  void make(Progress& progress);
  void push(std::size_t number, const harmonize::FilledFrame& frame);
  Frame read(std::size_t number) const;

  dvi::job::Job job_;
  Task::Callback progress_;
  std::string report_;
  // Under the task's lock from here on.
  std::vector<std::string> names_;
  std::vector<std::size_t> order_;  // indices in order of time
  std::vector<bool> missing_;
  std::map<std::size_t, std::shared_ptr<const Frame>> made_;
  std::size_t next_ = 0;      // position in order_
  std::size_t max_made_ = 1;  // frames that wait in made_
  bool drained_ = false;      // no further frames are requested
  Task task_;                 // the last member, so that it ends before the others do
};

}  // namespace dvi::python
