#pragma once

// The only file that includes Eigen.

// Vector instructions in Eigen are off: with them the bits would depend on compiler and processor.
#define EIGEN_DONT_VECTORIZE
#define EIGEN_DONT_PARALLELIZE
#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
