#pragma once
// Function marks: the same source compiles for the host and, under nvcc, for the device.
#if defined(__CUDACC__)
#define JAXMPM_INLINE __host__ __device__ __forceinline__
#else
#define JAXMPM_INLINE inline __attribute__((always_inline))
#endif
