#pragma once
// Function marks: the same source compiles for the host and, under nvcc, for the device. JAXMPM_INLINE insists on inlining, JAXMPM_FUNCTION
// leaves it to the compiler.
#if defined(__CUDACC__)
#define JAXMPM_INLINE __host__ __device__ __forceinline__
#define JAXMPM_FUNCTION __host__ __device__ inline
#else
#define JAXMPM_INLINE inline __attribute__((always_inline))
#define JAXMPM_FUNCTION inline
#endif
