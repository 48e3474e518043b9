#include "dvi/objects/detect/onnx_runtime.h"

#include <array>
#include <cstdlib>
#include <iostream>
#include <map>
#include <mutex>
#include <type_traits>
#include <utility>

#include <dlfcn.h>
#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/objects/detect/onnx_runtime_api.h"

namespace dvi::objects {
namespace {

// From this version of the API on, opset 18 is supported, which exporters of the last years write.
constexpr std::uint32_t kApiVersion = 14;
constexpr std::uint32_t kMaxNamedVersion = 60;  // the newest version that is looked for by its name
constexpr const char* kLibraryName = "libonnxruntime.so";
constexpr const char* kModelRemedy =
    "export it as docs/detector.md describes, or give the masks that the tool of the network writes with --masks";

using GetApiBase = const OrtApiBase* (*)();

// Loads a library for the rest of the process. Returns null if it cannot be loaded.
void* open_library(const std::string& name) { return dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE); }

// Returns the entry of the API of a library, or null if it is another library.
GetApiBase find_entry(void* library) { return reinterpret_cast<GetApiBase>(dlsym(library, "OrtGetApiBase")); }

// Silences std::cerr, to which Debian's libonnx writes hundreds of lines about operators that ONNX Runtime registers again.
class QuietErrors {
 public:
  QuietErrors() : before_(std::cerr.rdbuf(nullptr)) {}
  ~QuietErrors() { std::cerr.rdbuf(before_); }  // which also clears the errors of writing to nothing
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;

 private:
  std::streambuf* before_;
};

// Releases an object of the API.
template <class T>
class Releaser {
 public:
  explicit Releaser(void (*release)(T*) = nullptr) : release_(release) {}
  void operator()(T* object) const { release_(object); }

 private:
  void (*release_)(T*);
};
template <class T>
using Owned = std::unique_ptr<T, Releaser<T>>;

// Throws InputError for a status that is an error.
class Checker {
 public:
  Checker(const OrtApi& api, fs::path model, std::string engine)
      : api_(api), model_(std::move(model)), engine_(std::move(engine)) {}

  void operator()(OrtStatus* status) const {
    if (status == nullptr) return;
    const Owned<OrtStatus> owned(status, Releaser<OrtStatus>(api_.ReleaseStatus));
    std::string text = api_.GetErrorMessage(status);
    for (char& c : text)
      if (c == '\n') c = ' ';
    throw InputError(model_, fmt::format("{} cannot run it: {}", engine_, text.substr(0, text.find_last_not_of(' ') + 1)),
                     kModelRemedy);
  }
  const std::string& engine() const { return engine_; }

 private:
  const OrtApi& api_;
  fs::path model_;
  std::string engine_;
};

template <class T>
Owned<T> own(T* object, void (*release)(T*)) {
  return Owned<T>(object, Releaser<T>(release));
}

// Converts the numbers of a tensor to float.
template <class T>
void append_values(const void* data, std::size_t count, std::vector<float>& out) {
  const T* values = static_cast<const T*>(data);
  out.assign(values, values + count);
}

// The numbers of a tensor in the memory of the library.
struct TensorData {
  const void* values;
  std::size_t count;
  ONNXTensorElementDataType type;
};

// Converts the numbers of a tensor to float. Returns false if their type is not supported.
bool convert(const TensorData& data, Tensor& out) {
  switch (data.type) {
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT:
      append_values<float>(data.values, data.count, out.values);
      return true;
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_DOUBLE:
      append_values<double>(data.values, data.count, out.values);
      return true;
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT16: {
      out.values.resize(data.count);
      if (data.count == 0) return true;
      const cv::Mat half(1, static_cast<int>(data.count), CV_16F, const_cast<void*>(data.values));
      half.convertTo(cv::Mat(1, static_cast<int>(data.count), CV_32F, out.values.data()), CV_32F);
      return true;
    }
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_UINT8:
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_BOOL:
      append_values<std::uint8_t>(data.values, data.count, out.values);
      break;
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_INT32:
      append_values<std::int32_t>(data.values, data.count, out.values);
      break;
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_INT64:
      append_values<std::int64_t>(data.values, data.count, out.values);
      break;
    default:
      return false;
  }
  out.has_whole_numbers = true;
  return true;
}

// An input with its memory, which the library reads.
struct Input {
  std::string name;
  cv::Mat pixels;                      // the image
  std::array<std::int64_t, 2> size{};  // the size of the image, for an input that asks for it
  std::vector<std::int64_t> shape;
  ONNXTensorElementDataType type = ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT;
};

class LoadedRuntime;

class OnnxRuntimeNetwork : public Network {
 public:
  OnnxRuntimeNetwork(std::shared_ptr<const LoadedRuntime> runtime, const OnnxFile& file, std::vector<std::string> outputs);

  std::string engine() const override { return check_.engine(); }
  bool runs_in_parallel() const override { return true; }
  std::vector<Tensor> run(const cv::Mat& image) const override;

 private:
  std::vector<Input> make_inputs(const cv::Mat& image) const;
  Owned<OrtValue> make_value(Input& input) const;
  Tensor read(const std::string& name, OrtValue* value) const;

  std::shared_ptr<const LoadedRuntime> runtime_;
  const OrtApi& api_;
  OnnxFile file_;
  std::vector<std::string> outputs_;
  Checker check_;
  Owned<OrtMemoryInfo> memory_;
  Owned<OrtSession> session_;
};

class LoadedRuntime : public OnnxRuntime, public std::enable_shared_from_this<LoadedRuntime> {
 public:
  LoadedRuntime(const OrtApi& api, std::string version) : api_(api), version_(std::move(version)) {
    OrtEnv* env = nullptr;
    Checker(api_, "", engine())(api_.CreateEnv(ORT_LOGGING_LEVEL_FATAL, "dvi", &env));
    env_ = own(env, api_.ReleaseEnv);
  }

  std::string version() const override { return version_; }
  std::string engine() const { return "ONNX Runtime " + version_; }
  const OrtApi& api() const { return api_; }
  const OrtEnv* env() const { return env_.get(); }
  std::unique_ptr<Network> open(const OnnxFile& file, const std::vector<std::string>& outputs) const override {
    return std::make_unique<OnnxRuntimeNetwork>(shared_from_this(), file, outputs);
  }

 private:
  const OrtApi& api_;
  std::string version_;
  Owned<OrtEnv> env_{nullptr, Releaser<OrtEnv>()};
};

OnnxRuntimeNetwork::OnnxRuntimeNetwork(std::shared_ptr<const LoadedRuntime> runtime, const OnnxFile& file,
                                       std::vector<std::string> outputs)
    : runtime_(std::move(runtime)),
      api_(runtime_->api()),
      file_(file),
      outputs_(std::move(outputs)),
      check_(api_, file.path, runtime_->engine()),
      memory_(nullptr, Releaser<OrtMemoryInfo>()),
      session_(nullptr, Releaser<OrtSession>()) {
  OrtSessionOptions* raw_options = nullptr;
  check_(api_.CreateSessionOptions(&raw_options));
  const Owned<OrtSessionOptions> options = own(raw_options, api_.ReleaseSessionOptions);
  // Images are processed in parallel instead, so that results are the same with any number of threads.
  check_(api_.SetIntraOpNumThreads(options.get(), 1));
  check_(api_.SetInterOpNumThreads(options.get(), 1));
  OrtSession* session = nullptr;
  const QuietErrors quiet;
  check_(api_.CreateSession(runtime_->env(), file.path.c_str(), options.get(), &session));
  session_ = own(session, api_.ReleaseSession);
  OrtMemoryInfo* memory = nullptr;
  check_(api_.CreateCpuMemoryInfo(OrtDeviceAllocator, OrtMemTypeDefault, &memory));
  memory_ = own(memory, api_.ReleaseMemoryInfo);
}

std::vector<Input> OnnxRuntimeNetwork::make_inputs(const cv::Mat& image) const {
  std::vector<Input> inputs;
  for (const TensorInfo& info : file_.inputs) {
    Input input;
    input.name = info.name;
    if (info.type == ElementType::int64) {  // the size that boxes are scaled to
      input.size = {image.size[3], image.size[2]};
      input.shape = {1, 2};
      input.type = ONNX_TENSOR_ELEMENT_DATA_TYPE_INT64;
    } else {
      const bool has_batch = info.shape.size() != 3;
      if (has_batch) input.shape.push_back(1);
      input.shape.insert(input.shape.end(), {3, image.size[2], image.size[3]});
      if (info.type == ElementType::float16) {
        image.convertTo(input.pixels, CV_16F);
        input.type = ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT16;
      } else if (info.type == ElementType::uint8) {
        image.convertTo(input.pixels, CV_8U);
        input.type = ONNX_TENSOR_ELEMENT_DATA_TYPE_UINT8;
      } else {
        input.pixels = image;
      }
    }
    inputs.push_back(std::move(input));
  }
  return inputs;
}

Owned<OrtValue> OnnxRuntimeNetwork::make_value(Input& input) const {
  void* data = input.pixels.empty() ? static_cast<void*>(input.size.data()) : input.pixels.data;
  const std::size_t bytes = input.pixels.empty() ? sizeof(input.size) : input.pixels.total() * input.pixels.elemSize();
  OrtValue* value = nullptr;
  check_(api_.CreateTensorWithDataAsOrtValue(memory_.get(), data, bytes, input.shape.data(), input.shape.size(), input.type,
                                             &value));
  return own(value, api_.ReleaseValue);
}

Tensor OnnxRuntimeNetwork::read(const std::string& name, OrtValue* value) const {
  const auto refuse = [&] {
    throw InputError(file_.path, fmt::format("its output '{}' is not a tensor of numbers", name),
                     "name the outputs to use in [output] of MODEL.toml (docs/detector.md)");
  };
  int is_tensor = 0;
  check_(api_.IsTensor(value, &is_tensor));
  if (is_tensor == 0) refuse();
  OrtTensorTypeAndShapeInfo* raw_info = nullptr;
  check_(api_.GetTensorTypeAndShape(value, &raw_info));
  const Owned<OrtTensorTypeAndShapeInfo> info = own(raw_info, api_.ReleaseTensorTypeAndShapeInfo);
  TensorData data{};
  check_(api_.GetTensorElementType(info.get(), &data.type));
  std::size_t rank = 0;
  check_(api_.GetDimensionsCount(info.get(), &rank));
  std::vector<std::int64_t> shape(rank);
  check_(api_.GetDimensions(info.get(), shape.data(), rank));
  Tensor out;
  out.name = name;
  data.count = 1;
  for (const std::int64_t size : shape) {
    out.shape.push_back(static_cast<int>(size));
    data.count *= static_cast<std::size_t>(size);
  }
  void* values = nullptr;
  check_(api_.GetTensorMutableData(value, &values));
  data.values = values;
  if (!convert(data, out)) refuse();
  return out;
}

std::vector<Tensor> OnnxRuntimeNetwork::run(const cv::Mat& image) const {
  std::vector<Input> inputs = make_inputs(image);
  std::vector<Owned<OrtValue>> owned;
  std::vector<const OrtValue*> values;
  std::vector<const char*> input_names, output_names;
  for (Input& input : inputs) {
    owned.push_back(make_value(input));
    values.push_back(owned.back().get());
    input_names.push_back(input.name.c_str());
  }
  for (const std::string& name : outputs_) output_names.push_back(name.c_str());
  std::vector<OrtValue*> raw(outputs_.size(), nullptr);
  check_(api_.Run(session_.get(), nullptr, input_names.data(), values.data(), values.size(), output_names.data(),
                  output_names.size(), raw.data()));
  for (OrtValue* value : raw) owned.push_back(own(value, api_.ReleaseValue));
  std::vector<Tensor> out;
  for (std::size_t i = 0; i < raw.size(); ++i) out.push_back(read(outputs_[i], raw[i]));
  return out;
}

std::shared_ptr<const OnnxRuntime> make_runtime(const fs::path& file, GetApiBase get_base) {
  const OrtApiBase* base = get_base();
  const std::string version = base->GetVersionString();
  const OrtApi* api = base->GetApi(kApiVersion);
  if (api == nullptr)
    throw InputError(file, fmt::format("is ONNX Runtime {}, but version 1.{} or newer is needed", version, kApiVersion),
                     "install a newer version, or set DVI_ONNXRUNTIME=off to use OpenCV");
  return std::make_shared<LoadedRuntime>(*api, version);
}

// Loads a library by name or path. Returns null if there is none.
std::shared_ptr<const OnnxRuntime> try_load(const std::string& name) {
  void* library = open_library(name);
  const GetApiBase get_base = library == nullptr ? nullptr : find_entry(library);
  return get_base == nullptr ? nullptr : make_runtime(name, get_base);
}

// Finds a library. `given` is the value of DVI_ONNXRUNTIME.
std::shared_ptr<const OnnxRuntime> find_runtime(const std::string& given) {
  if (!given.empty()) return given == "off" ? nullptr : OnnxRuntime::load(given);
#ifdef DVI_LINKS_ONNX_RUNTIME
  return make_runtime(kLibraryName, &OrtGetApiBase);
#else
  for (const char* version : {".1", ""})
    if (auto runtime = try_load(std::string(kLibraryName) + version)) return runtime;
  // Debian 13 has libonnxruntime.so.1.21 alone.
  for (std::uint32_t version = kMaxNamedVersion; version >= kApiVersion; --version)
    if (auto runtime = try_load(fmt::format("{}.1.{}", kLibraryName, version))) return runtime;
  for (const fs::path& library : find_onnx_runtime_libraries())
    if (auto runtime = try_load(library.string())) return runtime;
  return nullptr;
#endif
}

}  // namespace

std::shared_ptr<const OnnxRuntime> OnnxRuntime::load(const fs::path& file) {
  require_regular_file(file);
  void* library = open_library(fs::absolute(file).string());
  if (library == nullptr)
    throw InputError(file, fmt::format("cannot be loaded: {}", dlerror()),
                     "DVI_ONNXRUNTIME takes the file libonnxruntime.so for this processor, or 'off' to use OpenCV");
  const GetApiBase get_base = find_entry(library);
  if (get_base == nullptr)
    throw InputError(file, "is not ONNX Runtime", "DVI_ONNXRUNTIME takes the file libonnxruntime.so, or 'off' to use OpenCV");
  return make_runtime(file, get_base);
}

std::shared_ptr<const OnnxRuntime> OnnxRuntime::of_process() {
  // Libraries are kept until the process ends: some cannot be initialized twice.
  static std::mutex mutex;
  static auto& known = *new std::map<std::string, std::shared_ptr<const OnnxRuntime>>;  // by the value of the variable
  const char* value = std::getenv("DVI_ONNXRUNTIME");
  const std::string given = value == nullptr ? "" : value;
  const std::scoped_lock lock(mutex);
  const auto found = known.find(given);
  return found != known.end() ? found->second : known.emplace(given, find_runtime(given)).first->second;
}

}  // namespace dvi::objects
