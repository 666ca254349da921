// Wider vectors where the processor has them, the same bytes everywhere.
#ifndef WIREPOSE_BASE_SIMD_H_
#define WIREPOSE_BASE_SIMD_H_

// Marks a kernel of plain loops that the compiler vectorizes: on x86-64 it is compiled for AVX2 as well and chosen at
// load time. Only for loops whose result does not depend on the vector width: integers, or floats lane by lane in
// source order (contraction is off everywhere). Other targets and sanitized builds compile it once.
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && defined(__OPTIMIZE__) && !defined(WIREPOSE_ONE_VECTOR_WIDTH)
#define WIREPOSE_VECTOR_KERNEL __attribute__((target_clones("avx2", "default")))
#else
#define WIREPOSE_VECTOR_KERNEL
#endif

// A part of a kernel: compiled into each of its versions. Called instead, it would be compiled for the narrowest one.
#ifdef __GNUC__
#define WIREPOSE_INLINE inline __attribute__((always_inline))
#else
#define WIREPOSE_INLINE inline
#endif

#endif  // WIREPOSE_BASE_SIMD_H_
