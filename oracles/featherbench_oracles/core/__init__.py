"""What every oracle is made of: messages, a robot's description, the engine's interface, the main loop. No module depends on an engine."""
