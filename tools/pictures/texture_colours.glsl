// The colour of the cube of checker_colours() that x is in, in units of cubes; GLSL 1.50 and ES 3.00.
vec3 cubeColour(vec3 x) {
  ivec3 cube = ivec3(floor(x));
  uint bits = uint(cube.x) * 73856093u ^ uint(cube.y) * 19349663u ^ uint(cube.z) * 83492791u;
  bits = (bits ^ (bits >> 13)) * 1540483477u;
  bits ^= bits >> 15;
  float brightness = 1.0 - 0.22 * float(bits >> 8) / 16777216.0;
  bool odd = ((cube.x + cube.y + cube.z) & 1) != 0;
  return brightness * (odd ? vec3(46.0, 106.0, 168.0) : vec3(246.0, 229.0, 196.0)) / 255.0;
}
