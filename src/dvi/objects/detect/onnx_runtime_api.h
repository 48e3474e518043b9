#pragma once

/// The C API of ONNX Runtime: its own header where the program is built against it, else the declarations of the functions that
/// are used. The library guarantees that the order of the functions in OrtApi never changes.
#ifdef DVI_LINKS_ONNX_RUNTIME
#include <onnxruntime_c_api.h>
#else

#include <cstddef>
#include <cstdint>

// NOLINTBEGIN(readability-identifier-naming): the names of the library
struct OrtEnv;
struct OrtMemoryInfo;
struct OrtSession;
struct OrtSessionOptions;
struct OrtStatus;
struct OrtTensorTypeAndShapeInfo;
struct OrtValue;

enum OrtLoggingLevel { ORT_LOGGING_LEVEL_FATAL = 4 };
enum OrtAllocatorType { OrtDeviceAllocator = 0 };
enum OrtMemType { OrtMemTypeDefault = 0 };
enum ONNXTensorElementDataType {
  ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT = 1,
  ONNX_TENSOR_ELEMENT_DATA_TYPE_UINT8 = 2,
  ONNX_TENSOR_ELEMENT_DATA_TYPE_INT32 = 6,
  ONNX_TENSOR_ELEMENT_DATA_TYPE_INT64 = 7,
  ONNX_TENSOR_ELEMENT_DATA_TYPE_BOOL = 9,
  ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT16 = 10,
  ONNX_TENSOR_ELEMENT_DATA_TYPE_DOUBLE = 11
};

/// The table of functions. A number is the position of the function that follows it.
struct OrtApi {
  using Unused = void (*)();
  Unused from_0[2];
  const char* (*GetErrorMessage)(const OrtStatus* status);  // 2
  OrtStatus* (*CreateEnv)(OrtLoggingLevel level, const char* log_name, OrtEnv** out);
  Unused from_4[3];
  OrtStatus* (*CreateSession)(const OrtEnv* env, const char* file, const OrtSessionOptions* options, OrtSession** out);  // 7
  Unused from_8[1];
  OrtStatus* (*Run)(OrtSession* session, const void* run_options, const char* const* input_names, const OrtValue* const* inputs,
                    std::size_t input_count, const char* const* output_names, std::size_t output_count,
                    OrtValue** outputs);  // 9
  OrtStatus* (*CreateSessionOptions)(OrtSessionOptions** out);
  Unused from_11[13];
  OrtStatus* (*SetIntraOpNumThreads)(OrtSessionOptions* options, int threads);  // 24
  OrtStatus* (*SetInterOpNumThreads)(OrtSessionOptions* options, int threads);
  Unused from_26[23];
  OrtStatus* (*CreateTensorWithDataAsOrtValue)(const OrtMemoryInfo* memory, void* data, std::size_t bytes,
                                               const std::int64_t* shape, std::size_t rank, ONNXTensorElementDataType type,
                                               OrtValue** out);  // 49
  OrtStatus* (*IsTensor)(const OrtValue* value, int* out);
  OrtStatus* (*GetTensorMutableData)(OrtValue* value, void** out);
  Unused from_52[8];
  OrtStatus* (*GetTensorElementType)(const OrtTensorTypeAndShapeInfo* info, ONNXTensorElementDataType* out);  // 60
  OrtStatus* (*GetDimensionsCount)(const OrtTensorTypeAndShapeInfo* info, std::size_t* out);
  OrtStatus* (*GetDimensions)(const OrtTensorTypeAndShapeInfo* info, std::int64_t* out, std::size_t count);
  Unused from_63[2];
  OrtStatus* (*GetTensorTypeAndShape)(const OrtValue* value, OrtTensorTypeAndShapeInfo** out);  // 65
  Unused from_66[3];
  OrtStatus* (*CreateCpuMemoryInfo)(OrtAllocatorType allocator, OrtMemType memory, OrtMemoryInfo** out);  // 69
  Unused from_70[22];
  void (*ReleaseEnv)(OrtEnv* env);  // 92
  void (*ReleaseStatus)(OrtStatus* status);
  void (*ReleaseMemoryInfo)(OrtMemoryInfo* info);
  void (*ReleaseSession)(OrtSession* session);
  void (*ReleaseValue)(OrtValue* value);
  Unused from_97[2];
  void (*ReleaseTensorTypeAndShapeInfo)(OrtTensorTypeAndShapeInfo* info);  // 99
  void (*ReleaseSessionOptions)(OrtSessionOptions* options);
};

static_assert(offsetof(OrtApi, ReleaseSessionOptions) == 100 * sizeof(void*), "the 101st function");

struct OrtApiBase {
  const OrtApi* (*GetApi)(std::uint32_t version);
  const char* (*GetVersionString)();
};
// NOLINTEND(readability-identifier-naming)

#endif
