// Placements, velocities and accelerations of bodies, and the Jacobian of one.

#include "robot.h"

#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>

namespace {

using pinocchio::LOCAL_WORLD_ALIGNED;

void placements(fb_handle &robot, size_t k) { pinocchio::forwardKinematics(robot.model, *robot.data, robot.q(k)); }

void velocities(fb_handle &robot, size_t k) { pinocchio::forwardKinematics(robot.model, *robot.data, robot.q(k), robot.v(k)); }

void accelerations(fb_handle &robot, size_t k) {
  pinocchio::forwardKinematics(robot.model, *robot.data, robot.q(k), robot.v(k), robot.a(k));
}

void read_placements(fb_handle &robot, double *value) {
  for (int i = 1; i < robot.model.njoints; i++, value += 12) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{value} = robot.data->oMi[i].rotation();
    Eigen::Map<Eigen::Vector3d>(value + 9) = robot.data->oMi[i].translation();
  }
}

// [angular; linear]: Pinocchio's 6-vectors begin with the linear part.
void write_motion(const pinocchio::Motion &motion, double *value) {
  Eigen::Map<Eigen::Vector3d>{value} = motion.angular();
  Eigen::Map<Eigen::Vector3d>(value + 3) = motion.linear();
}

void read_velocities(fb_handle &robot, double *value) {
  for (int i = 1; i < robot.model.njoints; i++, value += 6)
    write_motion(pinocchio::getVelocity(robot.model, *robot.data, i, LOCAL_WORLD_ALIGNED), value);
}

void read_accelerations(fb_handle &robot, double *value) {
  for (int i = 1; i < robot.model.njoints; i++, value += 6)
    write_motion(pinocchio::getClassicalAcceleration(robot.model, *robot.data, i, LOCAL_WORLD_ALIGNED), value);
}

void jacobian(fb_handle &robot, size_t k) {
  pinocchio::computeJointJacobians(robot.model, *robot.data, robot.q(k));
  pinocchio::getJointJacobian(robot.model, *robot.data, robot.body + 1, LOCAL_WORLD_ALIGNED, robot.jacobian);
}

void read_jacobian(fb_handle &robot, double *value) {
  for (int row = 0; row < 6; row++, value += robot.nv()) {
    write(robot.jacobian.row((row + 3) % 6).transpose(), value);
    fb_back(robot.change(), value);
  }
}

} // namespace

const std::vector<Method> kinematics = {
    {"body_placement", "forward_kinematics", nullptr, placements, read_placements},
    {"body_velocity", "forward_kinematics", nullptr, velocities, read_velocities},
    {"body_acceleration", "forward_kinematics", nullptr, accelerations, read_accelerations},
    {"body_jacobian", "joint_jacobian", nullptr, jacobian, read_jacobian},
};
