import type { AgentRenderer } from "./agent_renderer.ts";
import type { Camera } from "./camera.ts";
import type { Paint } from "./colouring.ts";
import type { Frame } from "./frame.ts";
import { outlineWidth, PackedAgents } from "./packed_agents.ts";
import type { Colour } from "./palettes.ts";

// One triangle around each disk. Its corners are found from gl_VertexID and the agents from a texture, so that there is one
// draw call and no instancing: software renderers draw instances one by one.
const VERTEX_SHADER = `#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D u_agents;  // x, y, radius or heading, place in the palette
uniform highp sampler2D u_palette;
uniform vec4 u_view;               // clip = xy * place + zw
uniform vec2 u_clip_per_pixel;
uniform float u_pixels;            // per unit of length
uniform float u_mark;              // radius of darts, or 0 where agents have radii
out vec2 v_offset;
flat out float v_radius;
flat out vec4 v_colour;
flat out vec2 v_heading;
void main() {
  int agent = gl_VertexID / 3;
  int corner = gl_VertexID - 3 * agent;
  vec4 data = texelFetch(u_agents, ivec2(agent & 2047, agent >> 11), 0);
  bool is_dart = u_mark > 0.0;
  float radius = (is_dart ? u_mark : data.z) * u_pixels;
  v_radius = max(radius, 0.7);
  v_colour = texelFetch(u_palette, ivec2(int(data.w), 0), 0);
  v_colour.a = radius < 0.7 ? radius * radius / 0.49 : 1.0;  // a disk below a pixel covers less of it
  v_heading = is_dart ? vec2(cos(data.z), sin(data.z)) : vec2(0.0);
  float around = is_dart ? 2.2 * v_radius + 1.0 : v_radius + 0.75;
  vec2 direction = corner == 0 ? vec2(0.0, 2.0) : corner == 1 ? vec2(-1.7320508, -1.0) : vec2(1.7320508, -1.0);
  v_offset = direction * around;
  gl_Position = vec4(data.xy * u_view.xy + u_view.zw + v_offset * u_clip_per_pixel, 0.0, 1.0);
}`;

const FRAGMENT_SHADER = `#version 300 es
precision highp float;
uniform vec3 u_ink;
uniform float u_outline;  // pixels; 0 for none
uniform float u_mark;
in vec2 v_offset;
flat in float v_radius;
flat in vec4 v_colour;
flat in vec2 v_heading;
out vec4 colour;
// How deep a pixel is in a dart: a triangle whose tip is ahead and whose sides are edges at these distances.
float depth_in_dart() {
  vec2 p = vec2(dot(v_offset, v_heading), abs(v_heading.x * v_offset.y - v_heading.y * v_offset.x));
  float side = dot(vec2(1.7 * v_radius, 0.0) - p, vec2(0.316, 0.949));
  return min(side, p.x + 1.2 * v_radius);
}
void main() {
  float depth = u_mark > 0.0 ? depth_in_dart() : v_radius - length(v_offset);
  float cover = clamp(depth + 0.5, 0.0, 1.0);
  if (cover == 0.0) discard;
  float inside = u_outline > 0.0 ? clamp(depth - u_outline + 0.5, 0.0, 1.0) : 1.0;
  cover *= v_colour.a;
  colour = vec4(mix(u_ink, v_colour.rgb, inside) * cover, cover);
}`;

const TEXTURE_WIDTH = 2048; // as in the shader; every WebGL 2 has it
const PALETTE_WIDTH = 512;

type Context = WebGL2RenderingContext;

function compile(gl: Context, type: number, source: string): WebGLShader {
  const shader = gl.createShader(type);
  if (shader === null) throw new Error("the browser made no shader; reload the page");
  gl.shaderSource(shader, source);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) {
    throw new Error(`the browser refused a shader: ${gl.getShaderInfoLog(shader) ?? ""}`);
  }
  return shader;
}

function link(gl: Context): WebGLProgram {
  const program = gl.createProgram();
  gl.attachShader(program, compile(gl, gl.VERTEX_SHADER, VERTEX_SHADER));
  gl.attachShader(program, compile(gl, gl.FRAGMENT_SHADER, FRAGMENT_SHADER));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    throw new Error(`the browser refused to link shaders: ${gl.getProgramInfoLog(program) ?? ""}`);
  }
  return program;
}

function texture(gl: Context): WebGLTexture {
  const made = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, made);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  return made;
}

/** Draws by WebGL 2. */
export class GraphicsRenderer implements AgentRenderer {
  private readonly gl: Context;
  private readonly program: WebGLProgram;
  private readonly agents: WebGLTexture;
  private readonly palette: WebGLTexture;
  private readonly locations = new Map<string, WebGLUniformLocation | null>();
  private readonly packed = new PackedAgents();
  private rows = 0;

  constructor(gl: WebGL2RenderingContext) {
    this.gl = gl;
    this.program = link(gl);
    gl.bindVertexArray(gl.createVertexArray());
    this.agents = texture(gl);
    this.palette = texture(gl);
  }

  load(frame: Frame, paint: Paint): void {
    this.packed.pack(frame, paint, TEXTURE_WIDTH);
    const gl = this.gl;
    const rows = Math.ceil(Math.max(1, this.packed.count) / TEXTURE_WIDTH);
    gl.bindTexture(gl.TEXTURE_2D, this.agents);
    if (rows > this.rows) {
      this.rows = rows;
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, TEXTURE_WIDTH, rows, 0, gl.RGBA, gl.FLOAT, null);
    }
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, TEXTURE_WIDTH, rows, gl.RGBA, gl.FLOAT, this.packed.numbers);
    const colours = new Uint8Array(4 * PALETTE_WIDTH);
    paint.palette.forEach((colour, i) =>
      colours.set(
        colour.map((part) => Math.round(255 * part)),
        4 * i,
      ),
    );
    gl.bindTexture(gl.TEXTURE_2D, this.palette);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, PALETTE_WIDTH, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, colours);
  }

  draw(camera: Camera, pixelRatio: number, ink: Colour): void {
    const gl = this.gl;
    const { width, height } = gl.canvas;
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    if (this.packed.count === 0) return;
    gl.useProgram(this.program);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    this.setView(camera, pixelRatio, ink);
    this.clip(camera, pixelRatio);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.palette);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.agents);
    gl.drawArrays(gl.TRIANGLES, 0, 3 * this.packed.count);
    gl.disable(gl.SCISSOR_TEST);
  }

  finish(): void {
    this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  dispose(): void {
    this.gl.deleteProgram(this.program);
    this.gl.deleteTexture(this.agents);
    this.gl.deleteTexture(this.palette);
  }

  private setView(camera: Camera, pixelRatio: number, ink: Colour): void {
    const gl = this.gl;
    const { width, height } = gl.canvas;
    const pixels = camera.scale * pixelRatio;
    const origin = camera.toPixels({ x: 0, y: 0 });
    const clip = { x: 2 / width, y: 2 / height };
    gl.uniform4f(
      this.location("u_view"),
      pixels * clip.x,
      pixels * clip.y,
      origin.x * pixelRatio * clip.x - 1,
      1 - origin.y * pixelRatio * clip.y,
    );
    gl.uniform2f(this.location("u_clip_per_pixel"), clip.x, clip.y);
    gl.uniform1f(this.location("u_pixels"), pixels);
    gl.uniform1f(this.location("u_mark"), this.packed.mark);
    gl.uniform1f(this.location("u_outline"), outlineWidth(this.packed.smallest * pixels, pixelRatio));
    gl.uniform3f(this.location("u_ink"), ...ink);
    gl.uniform1i(this.location("u_agents"), 0);
    gl.uniform1i(this.location("u_palette"), 1);
  }

  private clip(camera: Camera, pixelRatio: number): void {
    const clip = this.packed.clip(camera, pixelRatio);
    if (clip === undefined) return;
    this.gl.enable(this.gl.SCISSOR_TEST);
    this.gl.scissor(clip.left, this.gl.canvas.height - clip.bottom, clip.right - clip.left, clip.bottom - clip.top);
  }

  private location(name: string): WebGLUniformLocation | null {
    if (!this.locations.has(name)) this.locations.set(name, this.gl.getUniformLocation(this.program, name));
    return this.locations.get(name) ?? null;
  }
}
