#pragma once

// The one place that includes Eigen.

// Eigen's own vector instructions would make the bits depend on the compiler and the processor.
#define EIGEN_DONT_VECTORIZE
#define EIGEN_DONT_PARALLELIZE
#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
