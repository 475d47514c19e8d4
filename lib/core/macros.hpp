#pragma once
// Function marks: the same source compiles for the host and, in the .cu files of a CUDA build (JAXMPM_DEVICE_CODE), for the device. The
// other files stay host code, as packs of lanes cannot be on the device. JAXMPM_INLINE insists on inlining, JAXMPM_FUNCTION leaves it to
// the compiler.
// JAXMPM_UNROLL unrolls the loop that follows on the device, where an array whose indices are not known at compile time leaves the
// registers.
#if defined(JAXMPM_DEVICE_CODE)
#define JAXMPM_INLINE __host__ __device__ __forceinline__
#define JAXMPM_FUNCTION __host__ __device__ inline
#else
#define JAXMPM_INLINE inline __attribute__((always_inline))
#define JAXMPM_FUNCTION inline
#endif
// JAXMPM_ONCE keeps a function out of its callers: whoever calls it gets the same bits, however products and sums are joined elsewhere.
#define JAXMPM_ONCE __attribute__((noinline))
// JAXMPM_INLINE_LAMBDA, after the parameters, insists for a lambda on the host; instrumented builds take four times as long with it.
#if defined(__SANITIZE_ADDRESS__)
#define JAXMPM_INLINE_LAMBDA
#else
#define JAXMPM_INLINE_LAMBDA __attribute__((always_inline))
#endif
#if defined(__CUDA_ARCH__)
#define JAXMPM_UNROLL _Pragma("unroll")
#else
#define JAXMPM_UNROLL
#endif
