"""The converters of URDF and MJCF to USD, as writers."""
