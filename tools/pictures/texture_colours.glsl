// Textures as functions of x, the rest position in units of checker_colours()' cubes; GLSL 1.50 and ES 3.00.
const vec3 CREAM = vec3(246.0, 229.0, 196.0) / 255.0, BLUE = vec3(46.0, 106.0, 168.0) / 255.0;

// Of a cube, the same at every call: the eye tells cubes apart.
float brightness(ivec3 cube) {
  uint bits = uint(cube.x) * 73856093u ^ uint(cube.y) * 19349663u ^ uint(cube.z) * 83492791u;
  bits = (bits ^ (bits >> 13)) * 1540483477u;
  bits ^= bits >> 15;
  return 1.0 - 0.22 * float(bits >> 8) / 16777216.0;
}

vec3 checkerColour(vec3 x) {
  ivec3 cube = ivec3(floor(x));
  return brightness(cube) * (((cube.x + cube.y + cube.z) & 1) != 0 ? BLUE : CREAM);
}

// Across the diagonal of the cubes, so that no face along the axes has one colour.
vec3 stripesColour(vec3 x) {
  int stripe = int(floor(2.0 * (x.x + x.y + x.z)));
  return brightness(ivec3(stripe, 0, 0)) * ((stripe & 1) != 0 ? BLUE : CREAM);
}

// The faces of the cubes, seen as lines.
vec3 gridColour(vec3 x) {
  vec3 away = abs(x - round(x));
  return min(away.x, min(away.y, away.z)) < 0.04 ? BLUE : brightness(ivec3(floor(x))) * CREAM;
}
