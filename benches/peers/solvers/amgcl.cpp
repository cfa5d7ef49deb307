// AMGCL for ctypes: smoothed aggregation, Gauss-Seidel smoothing, conjugate gradients; with 3x3 blocks as
// values, or with scalars and rigid movements.
#include <algorithm>
#include <vector>

#include <boost/range/iterator_range.hpp>
#include <boost/tuple/tuple.hpp>

#include <amgcl/adapter/block_matrix.hpp>
#include <amgcl/adapter/crs_tuple.hpp>
#include <amgcl/amg.hpp>
#include <amgcl/backend/builtin.hpp>
#include <amgcl/coarsening/smoothed_aggregation.hpp>
#include <amgcl/make_solver.hpp>
#include <amgcl/relaxation/gauss_seidel.hpp>
#include <amgcl/solver/cg.hpp>
#include <amgcl/value_type/static_matrix.hpp>

typedef amgcl::static_matrix<double, 3, 3> Block;

template <class Value, class Row> struct Method {
    typedef amgcl::backend::builtin<Value> Backend;
    typedef amgcl::make_solver<
        amgcl::amg<Backend, amgcl::coarsening::smoothed_aggregation, amgcl::relaxation::gauss_seidel>,
        amgcl::solver::cg<Backend>>
        Solver;

    static typename Solver::params parameters(double tolerance) {
        typename Solver::params parameters;
        parameters.solver.tol = tolerance;
        parameters.solver.maxiter = 500;
        parameters.precond.coarsening.aggr.eps_strong = 0.0;
        return parameters;
    }

    static int solve(void *state, long rows, const double *right, double *solution) {
        const Row *f = reinterpret_cast<const Row *>(right);
        std::vector<Row> b(f, f + rows * sizeof(double) / sizeof(Row));
        std::vector<Row> x(b.size(), amgcl::math::zero<Row>());
        int iterations;
        double residual;
        boost::tie(iterations, residual) = (*static_cast<Solver *>(state))(b, x);
        const double *found = reinterpret_cast<const double *>(&x[0]);
        std::copy(found, found + rows, solution);
        return iterations;
    }
};

typedef Method<Block, amgcl::static_matrix<double, 3, 1>> Blocks;
typedef Method<double, double> Rigid;

static auto view(long rows, int *start, int *columns, double *values) {
    return boost::make_tuple(
        rows,
        boost::make_iterator_range(start, start + rows + 1),
        boost::make_iterator_range(columns, columns + start[rows]),
        boost::make_iterator_range(values, values + start[rows]));
}

extern "C" {
void *setup_block(long rows, int *start, int *columns, double *values, double *, double tolerance) {
    auto matrix = view(rows, start, columns, values);
    auto parameters = Blocks::parameters(tolerance);
    return new Blocks::Solver(amgcl::adapter::block_matrix<3, Block>(matrix), parameters);
}

void *setup_rigid(long rows, int *start, int *columns, double *values, double *modes, double tolerance) {
    auto parameters = Rigid::parameters(tolerance);
    parameters.precond.coarsening.aggr.block_size = 3;
    parameters.precond.coarsening.nullspace.cols = 6;
    parameters.precond.coarsening.nullspace.B.assign(modes, modes + 6 * rows);
    return new Rigid::Solver(view(rows, start, columns, values), parameters);
}

int solve_block(void *state, long rows, double *right, double *solution) {
    return Blocks::solve(state, rows, right, solution);
}

int solve_rigid(void *state, long rows, double *right, double *solution) {
    return Rigid::solve(state, rows, right, solution);
}

void release_block(void *state) { delete static_cast<Blocks::Solver *>(state); }

void release_rigid(void *state) { delete static_cast<Rigid::Solver *>(state); }
}
