#include <malloc.h>

#include <string>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <nlohmann/json.hpp>

#include <opencv2/imgproc.hpp>

#include "dvi/cli/run_program.h"
#include "dvi/commands/check.h"
#include "dvi/commands/evaluate_result.h"
#include "dvi/commands/find_recorded_input.h"
#include "dvi/commands/import_fill.h"
#include "dvi/commands/label_scans.h"
#include "dvi/commands/make_masks.h"
#include "dvi/core/error.h"
#include "dvi/core/json_text.h"
#include "dvi/core/version.h"
#include "dvi/exports/exporter.h"
#include "dvi/exports/map_cloud.h"
#include "dvi/job/request.h"
#include "dvi/media/write_image.h"
#include "dvi/metrics/evaluate.h"
#include "dvi/run/make_map.h"
#include "frames.h"
#include "task.h"

namespace dvi::python {
namespace {

namespace py = pybind11;
using Strings = std::vector<std::string>;

// A value as --set takes it, or a list of strings.
OptionValue to_value(const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return std::string(py::cast<bool>(value) ? "true" : "false");
  if (!py::isinstance<py::list>(value) && !py::isinstance<py::tuple>(value)) return py::cast<std::string>(py::str(value));
  Strings list;
  for (const py::handle item : value) list.push_back(py::cast<std::string>(py::str(item)));
  return list;
}

// The option of a keyword, as Python refuses an unknown one.
const Option& find_keyword(const OptionTable& table, const std::string& keyword, const Strings& others = {}) {
  try {
    return table.find_keyword(keyword, others);
  } catch (const UsageError& e) {
    throw py::type_error(e.what());
  }
}

job::Request to_request(const py::dict& given) {
  job::Job defaults;
  const OptionTable table = defaults.table();
  job::Request request;
  for (const auto& [key, value] : given) {
    const auto name = py::cast<std::string>(key);
    if (value.is_none()) continue;
    if (name == "config")
      request.config = py::cast<std::string>(py::str(value));
    else if (name == "set")
      for (const auto& [option, setting] : py::cast<py::dict>(value))
        request.assignments.push_back({py::cast<std::string>(py::str(option)), to_value(setting)});
    else
      request.assignments.push_back({find_keyword(table, name, {"config", "set"}).name(), to_value(value)});
  }
  return request;
}

// Runs work that returns a text, with the GIL given up.
template <class Work>
std::string run_task(int threads, const py::object& progress, Work work) {
  std::string result;
  Task task(threads, [&](Progress& p) { result = work(p); });
  task.start();
  task.finish(progress);
  return result;
}

using Bytes = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>;

void write_rgb(const std::string& path, const Bytes& rgb) {
  const cv::Mat view(static_cast<int>(rgb.shape(0)), static_cast<int>(rgb.shape(1)), CV_8UC3,
                     const_cast<std::uint8_t*>(rgb.data()));
  const py::gil_scoped_release released;
  cv::Mat bgr;
  cv::cvtColor(view, bgr, cv::COLOR_RGB2BGR);
  dvi::media::write_png(path, bgr);
}

void write_gray(const std::string& path, const Bytes& gray) {
  const cv::Mat view(static_cast<int>(gray.shape(0)), static_cast<int>(gray.shape(1)), CV_8UC1,
                     const_cast<std::uint8_t*>(gray.data()));
  const py::gil_scoped_release released;
  dvi::media::write_png(path, view);
}

py::tuple read_map(const std::string& ply) {
  const std::vector<exports::CloudPoint> cloud = exports::read_map_cloud(ply);
  const auto rows = static_cast<py::ssize_t>(cloud.size());
  py::array_t<float> points({rows, py::ssize_t{3}});
  py::array_t<std::uint8_t> colors({rows, py::ssize_t{3}});
  for (py::ssize_t i = 0; i < rows; ++i)
    for (int k = 0; k < 3; ++k) {
      points.mutable_at(i, k) = cloud[static_cast<std::size_t>(i)].position[k];
      colors.mutable_at(i, k) = cloud[static_cast<std::size_t>(i)].color[2 - k];
    }
  return py::make_tuple(points, colors);
}

void bind_frames(py::module_& m) {
  py::class_<Frame, std::shared_ptr<Frame>> frame(m, "Frame");
  frame.def_readonly("camera", &Frame::camera).def_readonly("name", &Frame::name).def_readonly("index", &Frame::index);
  const auto array = [&](const char* name, cv::Mat Frame::* field) {
    frame.def_property_readonly(name, [field](const Frame& f) { return to_array(f.*field); });
  };
  array("image", &Frame::image), array("mask", &Frame::mask), array("kind", &Frame::kind);
  array("provenance", &Frame::provenance), array("confidence", &Frame::confidence), array("depth", &Frame::depth);

  py::class_<Run>(m, "Run")
      .def(py::init([](const std::string& target, const Strings& sources, const std::string& out, const py::dict& options,
                       bool force, int threads, const py::object& progress) {
             dvi::job::Job job = to_request(options).job(out, target, sources);
             job.force = force;
             return std::make_unique<Run>(std::move(job), threads, progress);
           }),
           py::arg("target"), py::arg("sources"), py::arg("out"), py::arg("options"), py::arg("force"), py::arg("threads"),
           py::arg("progress"))
      .def("next", [](Run& run) { return std::const_pointer_cast<Frame>(run.next()); })
      .def("finish", &Run::finish)
      .def("close", &Run::close)
      .def_property_readonly("report", &Run::report)
      .def_property_readonly("out", &Run::out);
}

void bind_commands(py::module_& m) {
  m.def("config", [](const py::dict& options, bool all) {
    dvi::job::Job job = to_request(options).job("", "", {});
    return job.table().dump_toml([all](const Option& option) { return all || option.audience == Audience::user; });
  });
  m.def("check", [](const std::string& drive, const std::string& out, const py::dict& options, bool coverage, int threads,
                    const py::object& progress) {
    const dvi::job::Job job = to_request(options).job(out, drive, {});
    return run_task(threads, progress,
                    [&](Progress& p) { return dvi::commands::to_json(dvi::commands::check(job, coverage, p)); });
  });
  m.def("map", [](const std::string& drive, const std::string& out, const std::string& trajectory, const py::dict& options,
                  int threads, const py::object& progress) {
    const dvi::job::Job job = to_request(options).job(out, drive, {});
    const auto format = dvi::result::parse_trajectory_format(trajectory);
    return run_task(threads, progress, [&](Progress& p) { return dvi::run::make_map(job, format, p); });
  });
  m.def("masks",
        [](const std::string& drive, const std::string& out, const py::dict& options, int threads, const py::object& progress) {
          const dvi::job::Job job = to_request(options).job(out, drive, {});
          return run_task(threads, progress, [&](Progress& p) { return dvi::commands::make_masks(job, p); });
        });
  m.def("evaluate", [](const std::string& out, const std::string& truth, const std::string& ignore, const std::string& masks,
                       const std::string& labels, const std::string& points, const Strings& external, int threads,
                       const py::object& progress) {
    const metrics::EvaluationFolders folders{out, truth, ignore, metrics::parse_external(external), masks};
    return run_task(threads, progress,
                    [&](Progress& p) { return json_text(dvi::commands::evaluate_result(folders, {labels, points}, p)); });
  });
  m.def("export", [](const std::string& format, const std::string& out, const std::string& folder, const py::dict& options,
                     int threads, const py::object& progress) {
    exports::ExportOptions chosen;
    OptionTable table;
    chosen.describe(table);
    for (const auto& [key, value] : options)
      table.assign({find_keyword(table, py::cast<std::string>(key)).name(), to_value(value)});
    const exports::ExportFormat& to = exports::find_export_format(format);
    return run_task(threads, progress, [&](Progress& p) {
      return exports::to_json(
          exports::export_result({out, folder, {dvi::commands::label_scans, dvi::commands::find_recorded_input}}, to, chosen,
                                 p),
          to.name);
    });
  });
  m.def("import_fill", [](const std::string& out, const std::string& frames, int threads, const py::object& progress) {
    return run_task(threads, progress, [&](Progress& p) {
      return dvi::commands::to_json(
          frames.empty() ? dvi::commands::undo_import(out, p) : dvi::commands::import_fill(out, frames, p), out);
    });
  });
}

// Runs the command line of the program.
int run_program(Strings arguments) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const py::gil_scoped_release released;
  return cli::run_program(static_cast<int>(arguments.size()), argv.data());
}

}  // namespace

PYBIND11_MODULE(_dvi, m) {
  m.doc() = "The compiled part of the package dvi.";
  // As the program does: freed images stay for the next ones.
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
  m.attr("version") = kVersion;
  py::register_exception<InputError>(m, "InputError", PyExc_ValueError);
  py::register_exception<UsageError>(m, "UsageError", PyExc_ValueError);
  py::register_exception_translator([](std::exception_ptr error) {
    try {
      if (error) std::rethrow_exception(error);
    } catch (const Interrupted& e) {
      PyErr_SetString(PyExc_KeyboardInterrupt, e.what());
    }
  });
  bind_frames(m);
  bind_commands(m);
  m.def("write_rgb", &write_rgb);
  m.def("write_gray", &write_gray);
  m.def("read_map", &read_map);
  m.def("main", &run_program);
}

}  // namespace dvi::python
