// The centre of mass, and the momentum about it.

#include "robot.h"

#include <pinocchio/algorithm/center-of-mass.hpp>
#include <pinocchio/algorithm/centroidal.hpp>

namespace {

// Of the whole robot: without the centres of its sub-trees, which a caller can leave out.
void center(fb_handle &robot, size_t k) { pinocchio::centerOfMass(robot.model, *robot.data, robot.q(k), false); }

void read_center(fb_handle &robot, double *com) { Eigen::Map<Eigen::Vector3d>{com} = robot.data->com[0]; }

void momentum(fb_handle &robot, size_t k) { pinocchio::computeCentroidalMomentum(robot.model, *robot.data, robot.q(k), robot.v(k)); }

// [angular; linear]: Pinocchio's 6-vectors begin with the linear part.
void read_momentum(fb_handle &robot, double *value) {
  Eigen::Map<Eigen::Vector3d>{value} = robot.data->hg.angular();
  Eigen::Map<Eigen::Vector3d>(value + 3) = robot.data->hg.linear();
}

} // namespace

const std::vector<Method> momenta = {
    {"com", "center_of_mass", nullptr, center, read_center},
    {"momentum", "centroidal_momentum", nullptr, momentum, read_momentum},
};
