#pragma once

#include <memory>
#include <string>
#include <vector>

#include "dvi/objects/detect/network.h"

namespace dvi::objects {

/// The library ONNX Runtime, through its C API. Where the program is not built against it, the library is loaded when it is
/// first used.
class OnnxRuntime {
 public:
  /// Returns the library of this process, or null if there is none. It is the file in the environment variable
  /// DVI_ONNXRUNTIME, else the one that the program is built against, else that of the system, else that of a Python
  /// installation (find_onnx_runtime_libraries()). DVI_ONNXRUNTIME=off returns null. Throws InputError if the file in the
  /// variable cannot be used.
  static std::shared_ptr<const OnnxRuntime> of_process();

  /// Loads a library. Throws InputError if it cannot be loaded, is not ONNX Runtime, or is older than version 1.14.
  static std::shared_ptr<const OnnxRuntime> load(const fs::path& library);

  virtual ~OnnxRuntime() = default;
  /// Returns the version, such as "1.21.0".
  virtual std::string version() const = 0;
  /// Opens a network, whose run() returns the outputs of these names. Throws InputError if the library cannot run it.
  virtual std::unique_ptr<Network> open(const OnnxFile& file, const std::vector<std::string>& outputs) const = 0;
};

/// Lists the libraries of ONNX Runtime in Python installations: those of an active virtual or conda environment, those on the
/// PATH, and those of the system and of the user.
std::vector<fs::path> find_onnx_runtime_libraries();

}  // namespace dvi::objects
