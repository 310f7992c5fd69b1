// Runs the plug-in as a controller manager does: set point and measurements from stdin, commands to stdout.
#include "ros2_control_stub.hpp"

#include <iostream>

using controller_interface::CallbackReturn;
std::unique_ptr<controller_interface::ControllerInterface> made();

int main(int, char ** words)
{
  auto plugin = made();
  const rclcpp_lifecycle::State state;
  plugin->rate = std::stoul(words[1]);
  if (plugin->on_init() != CallbackReturn::SUCCESS) return 2;
  for (const auto & name : plugin->command_interface_configuration().names) std::cout << name << "\n";
  for (const auto & name : plugin->state_interface_configuration().names) std::cout << name << "\n";
  if (plugin->on_configure(state) != CallbackReturn::SUCCESS) return 3;
  double voltage = 9.0, position = 0.0, velocity = 0.0, wanted = 0.0;
  plugin->command_interfaces_ = {controller_interface::Loaned(voltage)};
  plugin->state_interfaces_ = {controller_interface::Loaned(position), controller_interface::Loaned(velocity)};
  if (plugin->on_activate(state) != CallbackReturn::SUCCESS) return 4;
  auto topic = std::static_pointer_cast<rclcpp::Subscription<std_msgs::msg::Float64>>(plugin->node->subscription);
  std::cout.precision(17);
  std::string cells[3];
  while (std::cin >> cells[0] >> cells[1] >> cells[2]) {
    wanted = std::stod(cells[0]), position = std::stod(cells[1]), velocity = std::stod(cells[2]);
    topic->heard({wanted});
    if (plugin->update({}, {}) != controller_interface::return_type::OK) return 5;
    std::cout << voltage << "\n";
  }
  (void)plugin->on_deactivate(state);
  std::cout << voltage << std::endl;
  return 0;
}
