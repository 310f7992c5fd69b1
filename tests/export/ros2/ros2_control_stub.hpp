// The members of ros2_control that docs/howto/ros2.md uses, without ROS 2: for its test only.
#pragma once
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace rclcpp
{
class Time {};
class Duration {};

struct Logger {};

struct Parameter
{
  std::string text;
  std::string as_string() const { return text; }
};

template <class Message>
struct Subscription
{
  using SharedPtr = std::shared_ptr<Subscription>;
  std::function<void(const Message &)> heard;
};
}  // namespace rclcpp

namespace rclcpp_lifecycle
{
class State {};

struct LifecycleNode
{
  std::map<std::string, std::string> parameters;
  std::shared_ptr<void> subscription;
  rclcpp::Logger get_logger() const { return {}; }
  rclcpp::Parameter get_parameter(const std::string & name) const { return {parameters.at(name)}; }

  template <class Message>
  typename rclcpp::Subscription<Message>::SharedPtr create_subscription(
    const std::string &, int, std::function<void(const Message &)> heard)
  {
    auto made = std::make_shared<rclcpp::Subscription<Message>>();
    made->heard = heard;
    subscription = made;
    return made;
  }
};
}  // namespace rclcpp_lifecycle

namespace realtime_tools
{
template <class Value>
class RealtimeBuffer
{
public:
  explicit RealtimeBuffer(const Value & value) : value_(value) {}
  void writeFromNonRT(const Value & value) { value_ = value; }
  Value * readFromRT() { return &value_; }

private:
  Value value_;
};
}  // namespace realtime_tools

namespace std_msgs::msg
{
struct Float64
{
  double data = 0.0;
};
}  // namespace std_msgs::msg

namespace controller_interface
{
enum class CallbackReturn { SUCCESS, FAILURE, ERROR };
enum class return_type { OK, ERROR };
enum class interface_configuration_type { ALL, INDIVIDUAL, NONE };

struct InterfaceConfiguration
{
  interface_configuration_type type;
  std::vector<std::string> names = {};
};

class Loaned
{
public:
  explicit Loaned(double & value) : value_(&value) {}
  [[nodiscard]] bool set_value(double value) { *value_ = value; return true; }
  double get_value() const { return *value_; }

private:
  double * value_;
};

class ControllerInterface
{
public:
  virtual ~ControllerInterface() = default;
  virtual CallbackReturn on_init() = 0;
  virtual InterfaceConfiguration command_interface_configuration() const = 0;
  virtual InterfaceConfiguration state_interface_configuration() const = 0;
  virtual CallbackReturn on_configure(const rclcpp_lifecycle::State &) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_activate(const rclcpp_lifecycle::State &) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_deactivate(const rclcpp_lifecycle::State &) { return CallbackReturn::SUCCESS; }
  virtual return_type update(const rclcpp::Time &, const rclcpp::Duration &) = 0;
  unsigned int get_update_rate() const { return rate; }
  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> get_node() const { return node; }

  template <class Value>
  void auto_declare(const std::string & name, const Value & value) { node->parameters[name] = value; }

  unsigned int rate = 1000;
  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node = std::make_shared<rclcpp_lifecycle::LifecycleNode>();
  std::vector<Loaned> command_interfaces_ = {};
  std::vector<Loaned> state_interfaces_ = {};
};
}  // namespace controller_interface

#define RCLCPP_ERROR(logger, ...) ((void)(logger), std::fprintf(stderr, __VA_ARGS__), std::fputc('\n', stderr))
#define PLUGINLIB_EXPORT_CLASS(kind, base) \
  std::unique_ptr<base> made() { return std::make_unique<kind>(); }
