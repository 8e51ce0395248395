// Generated from server/stream/src/protocol.rs and server/scene; do not edit.
// TYNDALL_BLESS=1 cargo test -p tyndall-stream typescript

export const PROTOCOL_VERSION = 1;
export const HEADER_VERSION = 1;
export const HEADER_BYTES = 64;
export const CODEC_JPEG = 1;
export const CODEC_PNG = 2;

/**
 * Acknowledges a frame and all before it.
 */
export type Ack = { 
/**
 * `frame_id` of the header.
 */
frame: number, };

/**
 * What renders.
 */
export type Adapter = { 
/**
 * The device's name.
 */
name: string, 
/**
 * The driver's name and version.
 */
driver: string, 
/**
 * Kind of device.
 */
kind: AdapterKind, };

/**
 * Kind of device.
 */
export type AdapterKind = "gpu" | "software" | "other";

/**
 * How time goes on.
 */
export type AnimationDescription = { 
/**
 * After which everything starts over; without it everything keeps the state of its last
 * keyframe. Unit: s. Range: 0.001 to 1e6.
 */
period_seconds?: number, };

/**
 * An axis-aligned box.
 */
export type Bounds = { 
/**
 * Lowest corner. Unit: m.
 */
min: [number, number, number], 
/**
 * Highest corner; above `min` in every component. Unit: m.
 */
max: [number, number, number], };

/**
 * An axis-aligned box.
 */
export type BoxGeometry = { 
/**
 * Name for people and messages. At most 200 characters.
 */
name?: string, 
/**
 * Lowest corner. Unit: m.
 */
min: [number, number, number], 
/**
 * Highest corner; above `min` in every component. Unit: m.
 */
max: [number, number, number], 
/**
 * Surface.
 */
material: MaterialDescription, 
/**
 * Placement; identity if left out.
 */
transform?: Transform, 
/**
 * Placement at which time, in order of time; replaces `transform`.
 */
keyframes?: Array<TransformKeyframe>, };

/**
 * Perspective pinhole camera.
 */
export type CameraDescription = { 
/**
 * Unit: m.
 */
position: [number, number, number], 
/**
 * The point looked at; at least 1e−6 m from `position`. Unit: m.
 */
target: [number, number, number], 
/**
 * Any length; not parallel to the view direction.
 */
up: [number, number, number], 
/**
 * Full vertical field of view. Unit: degree. Range: 0.1 to 170.
 */
vertical_fov_degrees: number, 
/**
 * Exposure value: displayed = curve(radiance · 2^`exposure_ev`). Range: −24 to 24.
 */
exposure_ev: number, 
/**
 * Where the camera is at which time, in order of time; replaces the pose above.
 * Linear in between.
 */
keyframes?: Array<CameraKeyframe>, };

/**
 * The camera at one time.
 */
export type CameraKeyframe = { 
/**
 * Later than the keyframe before. Unit: s. Range: 0 to 1e6.
 */
time_seconds: number, 
/**
 * Unit: m.
 */
position: [number, number, number], 
/**
 * Unit: m.
 */
target: [number, number, number], 
/**
 * The camera's own field of view if left out. Unit: degree. Range: 0.1 to 170.
 */
vertical_fov_degrees?: number, };

/**
 * A surface stopped the eye: the camera that is shown instead of the one that was sent.
 */
export type CameraMessage = { 
/**
 * Input number of the camera that was sent.
 */
input: number, 
/**
 * Where the eye is.
 */
camera: CameraPose, };

/**
 * Where the eye is; exposure stays as it is, keyframes are left.
 */
export type CameraPose = { 
/**
 * Unit: m.
 */
position: [number, number, number], 
/**
 * The point looked at. Unit: m.
 */
target: [number, number, number], 
/**
 * Any length; not parallel to the view direction.
 */
up: [number, number, number], 
/**
 * Full vertical field of view. Unit: degree.
 */
vertical_fov_degrees: number, };

/**
 * Moves the eye.
 */
export type CameraUpdate = { 
/**
 * The client's input number.
 */
input: number, 
/**
 * Where to.
 */
camera: CameraPose, 
/**
 * The eye stops before surfaces and slides along them; where it ends elsewhere than it was sent, a
 * [`ServerMessage::Camera`] says so. Without this it goes through them.
 */
stops_at_surfaces?: boolean, };

/**
 * What a client says.
 */
export type ClientMessage = { "type": "hello" } & Hello | { "type": "camera" } & CameraUpdate | { "type": "edit" } & EditRequest | { "type": "open_preset" } & OpenPreset | { "type": "resize" } & Resize | { "type": "ack" } & Ack | { "type": "visible" } & Visible | { "type": "pick" } & Pick | { "type": "explain_darkness" } & ExplainDarkness;

/**
 * The clock of a session whose scene moves; edits set it.
 */
export type ClockState = { 
/**
 * Whether time goes on.
 */
playing: boolean, 
/**
 * The time shown. Unit: s.
 */
time_seconds: number, 
/**
 * After which the scene starts over or stands still. Unit: s.
 */
duration_seconds: number, };

/**
 * How a frame's payload is compressed.
 */
export type Codec = "jpeg" | "png";

/**
 * When unbiased traced samples correct the technique's picture.
 */
export type CorrectionMode = "off" | "at_rest" | "always";

/**
 * Why a picture is black.
 */
export type DarknessCause = "no_light" | "inside_solid" | "at_surface" | "looks_away" | "unlit";

/**
 * Answers the question why the picture is black.
 */
export type DarknessMessage = { 
/**
 * Number of the question.
 */
request: number, 
/**
 * The first reason that applies.
 */
cause: DarknessCause, };

/**
 * A light's direction at one time.
 */
export type DirectionKeyframe = { 
/**
 * Later than the keyframe before. Unit: s. Range: 0 to 1e6.
 */
time_seconds: number, 
/**
 * In which the light travels; any length above 1e−6. Turns along the shortest arc; not
 * opposite to the keyframe before.
 */
direction: [number, number, number], };

/**
 * Parallel light from infinity.
 */
export type DirectionalLightDescription = { 
/**
 * Name for people and messages. At most 200 characters.
 */
name?: string, 
/**
 * In which the light travels; any length above 1e−6.
 */
direction: [number, number, number], 
/**
 * On a plane perpendicular to `direction`. Unit: W·m⁻². Range: 0 to 1e9.
 */
irradiance: Rgb, 
/**
 * Whether surfaces block this light.
 */
casts_shadows: boolean, 
/**
 * Where it is at which time, in order of time; replaces the pose above.
 */
keyframes?: Array<DirectionKeyframe>, };

/**
 * Changes the open scene.
 */
export type EditRequest = { 
/**
 * The client's input number.
 */
input: number, 
/**
 * What to change.
 */
edit: SceneEdit, };

/**
 * Radiance from infinity.
 */
export type EnvironmentDescription = { 
/**
 * Name for people and messages. At most 200 characters.
 */
name?: string, 
/**
 * Multiplies the map, or is the radiance itself. Unit: W·m⁻²·sr⁻¹. Range: 0 to 1e9.
 */
radiance: Rgb, 
/**
 * Equirectangular `.hdr` or `.exr`, relative to the scene's folder and inside it.
 */
map?: string, 
/**
 * Rotation of the map about +Y. Unit: degree. Range: −360 to 360.
 */
rotation_degrees: number, };

/**
 * Stable names of causes, shared by the WebSocket and by HTTP problems.
 */
export type ErrorCode = "malformed" | "not_found" | "method_not_allowed" | "unauthorized" | "too_many_attempts" | "origin_refused" | "too_large" | "unsupported_media_type" | "invalid_scene" | "not_rendered_yet" | "invalid_size" | "protocol_version" | "hello_expected" | "no_common_codec" | "too_many_sessions" | "taken_over" | "not_ready" | "took_too_long" | "render_failed" | "internal" | "conflict" | "queue_full" | "invalid_upload" | "range_not_satisfiable" | "storage_failed";

/**
 * Why something was refused or broke.
 */
export type ErrorMessage = { 
/**
 * Stable name of the cause.
 */
code: ErrorCode, 
/**
 * JSON path in the scene or message, where there is one.
 */
path?: string, 
/**
 * One sentence for people.
 */
message: string, 
/**
 * Input number of the message that was refused.
 */
input?: number, };

/**
 * Asks why the picture that the session's camera sees is black.
 */
export type ExplainDarkness = { 
/**
 * The client's number of the question; the answer carries it.
 */
request: number, };

/**
 * What the planner knows about a scene; see `SceneFacts` for the exact meanings.
 */
export type Facts = { triangles: number, instances: number, textures: number, data_textures: number, alpha_masked_instances: number, emissive_triangles: number, point_lights: number, spot_lights: number, directional_lights: number, shadow_casters: number, environment: boolean, environment_map: boolean, media: number, grids: number, heterogeneous: boolean, scatters: boolean, medium_emits: boolean, anisotropic: boolean, max_abs_g: number, max_albedo: number, 
/**
 * An infinite thickness is the largest finite number: JSON knows no infinity.
 */
optical_thickness: number, };

/**
 * One entry of `geometry`.
 */
export type GeometryDescription = { "kind": "gltf" } & GltfGeometry | { "kind": "obj" } & ObjGeometry | { "kind": "mesh" } & MeshGeometry | { "kind": "box" } & BoxGeometry | { "kind": "sphere" } & SphereGeometry | { "kind": "quad" } & QuadGeometry;

/**
 * A glTF 2.0 file.
 */
export type GltfGeometry = { 
/**
 * Name for people and messages. At most 200 characters.
 */
name?: string, 
/**
 * `.gltf` or `.glb`, relative to the scene's folder and inside it.
 */
path: string, 
/**
 * Candela and lux of `KHR_lights_punctual` are divided by this. Unit: lm/W. Range: 1e−3 to
 * 1e6.
 */
luminous_efficacy: number, 
/**
 * Whether the file's lights are taken. Once loaded they stand in `lights`, and this is
 * false.
 */
import_lights: boolean, 
/**
 * Placement; identity if left out.
 */
transform?: Transform, 
/**
 * Placement at which time, in order of time; replaces `transform`.
 */
keyframes?: Array<TransformKeyframe>, };

/**
 * A voxel grid in a file. Formats that carry no placement fill the unit cube [0, 1]³ before
 * `transform`.
 */
export type GridMedium = { 
/**
 * Name for people and messages. At most 200 characters.
 */
name?: string, 
/**
 * Scattering coefficient at density 1, together with `sigma_a`. Unit: m⁻¹.
 * Range: 0 to 1e6.
 */
sigma_s?: Rgb, 
/**
 * Absorption coefficient at density 1, together with `sigma_s`. Unit: m⁻¹.
 * Range: 0 to 1e6.
 */
sigma_a?: Rgb, 
/**
 * Extinction coefficient at density 1, together with `albedo`, instead of `sigma_s`
 * and `sigma_a`. Unit: m⁻¹. Range: 0 to 1e6.
 */
sigma_t?: Rgb, 
/**
 * Scattered share of `sigma_t`. Range: 0 to 1.
 */
albedo?: Rgb, 
/**
 * Henyey–Greenstein mean cosine, +1 forward. Range: −0.999 to 0.999.
 */
g: number, 
/**
 * Phase function, instead of `g`.
 */
phase?: PhaseDescription, 
/**
 * Emitted radiance per metre at density 1. Unit: W·m⁻³·sr⁻¹. Range: 0 to 1e9.
 */
emission: Rgb, 
/**
 * Factor on all coefficients and the emission. Range: 0 to 1e6.
 */
density_scale: number, 
/**
 * `.vdb`, `.nvdb`, `.vol`, `.npy`, `.npz` or `.raw`, relative to the scene's folder and
 * inside it.
 */
path: string, 
/**
 * Name of the grid in the file, where it holds several; `density` or the first one if
 * left out. At most 200 characters.
 */
grid?: string, 
/**
 * Applied after the file's own placement; identity if left out.
 */
transform?: Transform, };

/**
 * Exponential height fog.
 */
export type HeightFogMedium = { 
/**
 * Name for people and messages. At most 200 characters.
 */
name?: string, 
/**
 * Scattering coefficient at density 1, together with `sigma_a`. Unit: m⁻¹.
 * Range: 0 to 1e6.
 */
sigma_s?: Rgb, 
/**
 * Absorption coefficient at density 1, together with `sigma_s`. Unit: m⁻¹.
 * Range: 0 to 1e6.
 */
sigma_a?: Rgb, 
/**
 * Extinction coefficient at density 1, together with `albedo`, instead of `sigma_s`
 * and `sigma_a`. Unit: m⁻¹. Range: 0 to 1e6.
 */
sigma_t?: Rgb, 
/**
 * Scattered share of `sigma_t`. Range: 0 to 1.
 */
albedo?: Rgb, 
/**
 * Henyey–Greenstein mean cosine, +1 forward. Range: −0.999 to 0.999.
 */
g: number, 
/**
 * Phase function, instead of `g`.
 */
phase?: PhaseDescription, 
/**
 * Emitted radiance per metre at density 1. Unit: W·m⁻³·sr⁻¹. Range: 0 to 1e9.
 */
emission: Rgb, 
/**
 * Factor on all coefficients and the emission. Range: 0 to 1e6.
 */
density_scale: number, 
/**
 * In which the density falls; any length above 1e−6.
 */
up: [number, number, number], 
/**
 * Unit: m⁻¹. Range: 0 to 1000.
 */
falloff: number, 
/**
 * A point where the density is 1. Unit: m.
 */
origin: [number, number, number], 
/**
 * Where it is; all of space if left out.
 */
bounds?: Bounds, };

/**
 * Opens or resumes a session.
 */
export type Hello = { 
/**
 * [`PROTOCOL_VERSION`].
 */
protocol: number, 
/**
 * Codecs the client decodes; names this server does not know are skipped.
 */
accept: Array<string>, 
/**
 * Width of the picture wanted. Unit: device pixel.
 */
width: number, 
/**
 * Height of the picture wanted. Unit: device pixel.
 */
height: number, 
/**
 * `session` of an earlier welcome, to go on with its state.
 */
resume?: string | null, };

/**
 * One lobe.
 */
export type HenyeyGreensteinPhase = { 
/**
 * Mean cosine, +1 forward. Range: −0.999 to 0.999.
 */
g: number, };

/**
 * Equal everywhere inside its bounds, or in all of space.
 */
export type HomogeneousMedium = { 
/**
 * Name for people and messages. At most 200 characters.
 */
name?: string, 
/**
 * Scattering coefficient at density 1, together with `sigma_a`. Unit: m⁻¹.
 * Range: 0 to 1e6.
 */
sigma_s?: Rgb, 
/**
 * Absorption coefficient at density 1, together with `sigma_s`. Unit: m⁻¹.
 * Range: 0 to 1e6.
 */
sigma_a?: Rgb, 
/**
 * Extinction coefficient at density 1, together with `albedo`, instead of `sigma_s`
 * and `sigma_a`. Unit: m⁻¹. Range: 0 to 1e6.
 */
sigma_t?: Rgb, 
/**
 * Scattered share of `sigma_t`. Range: 0 to 1.
 */
albedo?: Rgb, 
/**
 * Henyey–Greenstein mean cosine, +1 forward. Range: −0.999 to 0.999.
 */
g: number, 
/**
 * Phase function, instead of `g`.
 */
phase?: PhaseDescription, 
/**
 * Emitted radiance per metre at density 1. Unit: W·m⁻³·sr⁻¹. Range: 0 to 1e9.
 */
emission: Rgb, 
/**
 * Factor on all coefficients and the emission. Range: 0 to 1e6.
 */
density_scale: number, 
/**
 * Where it is; all of space if left out.
 */
bounds?: Bounds, };

/**
 * How levels of the picture are read: between levels, and between the pixels of one.
 */
export type LevelFetch = "linear_bilinear" | "linear_bicubic" | "cubic_bicubic";

/**
 * One entry of `lights`.
 */
export type LightDescription = { "kind": "point" } & PointLightDescription | { "kind": "spot" } & SpotLightDescription | { "kind": "directional" } & DirectionalLightDescription | { "kind": "environment" } & EnvironmentDescription;

/**
 * Metallic-roughness surface.
 */
export type MaterialDescription = { 
/**
 * Linear reflectance; multiplies the texture. Range: 0 to 1.
 */
base_color: Rgb, 
/**
 * Range: 0 to 1.
 */
metallic: number, 
/**
 * Perceptual roughness. Range: 0 to 1.
 */
roughness: number, 
/**
 * Emitted radiance. Unit: W·m⁻²·sr⁻¹. Range: 0 to 1e9. Front only unless `double_sided`.
 */
emission: Rgb, 
/**
 * Both sides reflect and emit; otherwise triangles seen from behind are holes.
 */
double_sided: boolean, 
/**
 * Alpha of the texture below this is a hole. Range: 0 to 1.
 */
alpha_cutoff?: number, 
/**
 * sRGB image (`.png`, `.jpg`), relative to the scene's folder and inside it.
 */
base_color_texture?: string, };

/**
 * One entry of `media`.
 */
export type MediumDescription = { "kind": "homogeneous" } & HomogeneousMedium | { "kind": "height_fog" } & HeightFogMedium | { "kind": "sphere" } & SphereMedium | { "kind": "grid" } & GridMedium | { "kind": "procedural" } & ProceduralMedium;

/**
 * How often a path scatters in media.
 */
export type MediumOrder = "all" | "none" | "single" | "multiple";

/**
 * A triangle mesh written into the scene.
 */
export type MeshGeometry = { 
/**
 * Name for people and messages. At most 200 characters.
 */
name?: string, 
/**
 * Unit: m.
 */
positions: Array<[number, number, number]>, 
/**
 * Three indices into `positions` a triangle, counter-clockwise seen from the front.
 */
indices: Array<[number, number, number]>, 
/**
 * One a position, any length above zero; flat normals if left out.
 */
normals?: Array<[number, number, number]>, 
/**
 * One a position; (0, 0) is the image's upper left corner.
 */
texcoords?: Array<[number, number]>, 
/**
 * Surface.
 */
material: MaterialDescription, 
/**
 * Placement; identity if left out.
 */
transform?: Transform, 
/**
 * Placement at which time, in order of time; replaces `transform`.
 */
keyframes?: Array<TransformKeyframe>, };

/**
 * How a page steers the camera.
 */
export type Navigation = "look" | "orbit" | "fly";

/**
 * How to steer through the open scene. Follows the scene as soon as it is known.
 */
export type NavigationMessage = { 
/**
 * The scene's epoch.
 */
epoch: number, 
/**
 * What the scene says, or what suits it.
 */
mode: Navigation, 
/**
 * Box around what is worth looking at. Unit: m.
 */
bounds: Bounds, 
/**
 * What an orbit of the scene's own camera turns about. Unit: m.
 */
pivot: [number, number, number], 
/**
 * Where to stand to see most of a scene whose surfaces surround its camera.
 */
overview?: ViewPoint, };

/**
 * Something that the user may wonder about.
 */
export type Notice = { 
/**
 * One sentence for people.
 */
message: string, };

/**
 * A Wavefront OBJ file.
 */
export type ObjGeometry = { 
/**
 * Name for people and messages. At most 200 characters.
 */
name?: string, 
/**
 * `.obj`, relative to the scene's folder and inside it.
 */
path: string, 
/**
 * Placement; identity if left out.
 */
transform?: Transform, 
/**
 * Placement at which time, in order of time; replaces `transform`.
 */
keyframes?: Array<TransformKeyframe>, };

/**
 * Opens a built-in scene.
 */
export type OpenPreset = { 
/**
 * The client's input number.
 */
input: number, 
/**
 * A name of the welcome's `presets`.
 */
name: string, };

/**
 * Time of a pass on the device.
 */
export type PassTime = { 
/**
 * Name of the pass.
 */
name: string, 
/**
 * Unit: µs.
 */
micros: number, };

/**
 * `phase` of a medium: into which directions it scatters.
 */
export type PhaseDescription = { "kind": "henyey_greenstein" } & HenyeyGreensteinPhase | { "kind": "two_lobes" } & TwoLobesPhase;

/**
 * Asks what lies under a place of the picture that the session's camera sees.
 */
export type Pick = { 
/**
 * The client's number of the question; the answer carries it.
 */
request: number, 
/**
 * Shares of the picture's width and height, from the left upper corner. Range: 0 to 1.
 */
place: [number, number], };

/**
 * What was picked.
 */
export type PickedKind = "surface" | "medium";

/**
 * Answers a pick.
 */
export type PickedMessage = { 
/**
 * Number of the question.
 */
request: number, 
/**
 * What lies there; nothing where one sees past everything.
 */
hit?: PickedPoint, };

/**
 * A point of the scene under a place of the picture.
 */
export type PickedPoint = { 
/**
 * Of what.
 */
kind: PickedKind, 
/**
 * Unit: m.
 */
point: [number, number, number], 
/**
 * Unit normal of a surface, toward the eye.
 */
normal?: [number, number, number], };

/**
 * Passes that run and passes that don't.
 */
export type Plan = { 
/**
 * In the order of execution.
 */
passes: Array<PlannedPass>, 
/**
 * With the reason why not.
 */
skipped: Array<PlannedPass>, };

/**
 * What each frame does.
 */
export type PlanMessage = { 
/**
 * The plan.
 */
plan: Plan, };

/**
 * A pass and why it runs or does not.
 */
export type PlannedPass = { 
/**
 * Name of the pass, as in pass times and metrics.
 */
pass: string, 
/**
 * Which of its shaders.
 */
variant: string, 
/**
 * Why.
 */
reason: string, };

/**
 * Isotropic point light.
 */
export type PointLightDescription = { 
/**
 * Name for people and messages. At most 200 characters.
 */
name?: string, 
/**
 * Unit: m.
 */
position: [number, number, number], 
/**
 * Unit: W·sr⁻¹. Range: 0 to 1e12.
 */
intensity: Rgb, 
/**
 * Distances below this count as this in 1/d². Unit: m. Range: 1e−4 to 1000.
 */
radius: number, 
/**
 * Whether surfaces block this light.
 */
casts_shadows: boolean, 
/**
 * Where it is at which time, in order of time; replaces the pose above.
 */
keyframes?: Array<PositionKeyframe>, };

/**
 * A light's position at one time.
 */
export type PositionKeyframe = { 
/**
 * Later than the keyframe before. Unit: s. Range: 0 to 1e6.
 */
time_seconds: number, 
/**
 * Unit: m. Linear in between.
 */
position: [number, number, number], };

/**
 * A built-in scene.
 */
export type Preset = { 
/**
 * For `open_preset` and URLs.
 */
name: string, 
/**
 * For people.
 */
title: string, 
/**
 * One sentence.
 */
summary: string, };

/**
 * A voxel grid made from noise, with values from 0 to 1. Before `transform` it stands on
 * y = 0, centred over the origin, and its longest side is 1 m.
 */
export type ProceduralMedium = { 
/**
 * Name for people and messages. At most 200 characters.
 */
name?: string, 
/**
 * Scattering coefficient at density 1, together with `sigma_a`. Unit: m⁻¹.
 * Range: 0 to 1e6.
 */
sigma_s?: Rgb, 
/**
 * Absorption coefficient at density 1, together with `sigma_s`. Unit: m⁻¹.
 * Range: 0 to 1e6.
 */
sigma_a?: Rgb, 
/**
 * Extinction coefficient at density 1, together with `albedo`, instead of `sigma_s`
 * and `sigma_a`. Unit: m⁻¹. Range: 0 to 1e6.
 */
sigma_t?: Rgb, 
/**
 * Scattered share of `sigma_t`. Range: 0 to 1.
 */
albedo?: Rgb, 
/**
 * Henyey–Greenstein mean cosine, +1 forward. Range: −0.999 to 0.999.
 */
g: number, 
/**
 * Phase function, instead of `g`.
 */
phase?: PhaseDescription, 
/**
 * Emitted radiance per metre at density 1. Unit: W·m⁻³·sr⁻¹. Range: 0 to 1e9.
 */
emission: Rgb, 
/**
 * Factor on all coefficients and the emission. Range: 0 to 1e6.
 */
density_scale: number, 
/**
 * What is made.
 */
pattern: ProceduralPattern, 
/**
 * Another seed, another plume or cloud. Range: 0 to 2⁵³ − 1.
 */
seed: number, 
/**
 * Voxels along the longest side. Range: 8 to 256.
 */
resolution: number, 
/**
 * Octaves of noise, each of twice the frequency of the one before. Range: 1 to 8.
 */
octaves: number, 
/**
 * Placement; identity if left out.
 */
transform?: Transform, };

/**
 * What a procedural grid shows.
 */
export type ProceduralPattern = "smoke_plume" | "cloud";

/**
 * A parallelogram.
 */
export type QuadGeometry = { 
/**
 * Name for people and messages. At most 200 characters.
 */
name?: string, 
/**
 * Unit: m.
 */
corner: [number, number, number], 
/**
 * From `corner` along texture u. Unit: m.
 */
edge_u: [number, number, number], 
/**
 * From `corner` along texture v, upward in the image. Not parallel to `edge_u`. Unit: m.
 */
edge_v: [number, number, number], 
/**
 * Surface.
 */
material: MaterialDescription, 
/**
 * Placement; identity if left out.
 */
transform?: Transform, 
/**
 * Placement at which time, in order of time; replaces `transform`.
 */
keyframes?: Array<TransformKeyframe>, };

/**
 * Which paths the `reference` counts; all of them if nothing is said.
 *
 * A path from the camera over k points to a light has k scatterings, on surfaces or in media.
 */
export type Reference = { 
/**
 * Most scatterings of a path, k; unlimited if left out. Range: 0 to 65535.
 */
max_scatterings?: number, 
/**
 * Most scatterings on surfaces; unlimited if left out. Range: 0 to 65535.
 */
max_surface_scatterings?: number, 
/**
 * How often a path scatters in media.
 */
medium_order: MediumOrder, };

/**
 * How to render.
 */
export type RenderDescription = { 
/**
 * What transports the light.
 */
technique: Technique, 
/**
 * Unit: pixel. Range: 1 to 16384.
 */
width: number, 
/**
 * Unit: pixel. Range: 1 to 16384.
 */
height: number, 
/**
 * Finished after so many samples a pixel. Range: 1 to 65536. 64 if no rule is given; at most
 * one of `samples`, `time_seconds` and `relative_error`.
 */
samples?: number, 
/**
 * Finished after so many seconds of rendering. Unit: s. Range: 0.001 to 1e6.
 */
time_seconds?: number, 
/**
 * Finished when the estimated relative error falls below this. Range: 1e−5 to 1.
 */
relative_error?: number, 
/**
 * When traced samples correct the technique's picture. If left out: `always`, but `off` for the
 * `reference`, which they are all of.
 */
correction?: CorrectionMode, 
/**
 * Seed of every random number. Range: 0 to 2⁵³ − 1, which every JSON reader keeps exactly.
 */
seed: number, 
/**
 * Settings of the `single_scattering` march.
 */
single_scattering: SingleScattering, 
/**
 * Settings of the `screen_space` filter.
 */
screen_space: ScreenSpace, 
/**
 * Which paths the `reference` counts.
 */
reference: Reference, 
/**
 * How visibility toward lights is found.
 */
shadows: Shadows, };

/**
 * Changes the size of the picture.
 */
export type Resize = { 
/**
 * The client's input number.
 */
input: number, 
/**
 * Unit: device pixel.
 */
width: number, 
/**
 * Unit: device pixel.
 */
height: number, };

/**
 * A linear Rec. 709 RGB triple; a single number in JSON stands for three equal channels.
 */
export type Rgb = number | [number, number, number];

/**
 * A scale along x, y and z; a single number in JSON stands for a uniform scale.
 */
export type Scale = number | [number, number, number];

/**
 * A whole scene.
 */
export type SceneDescription = { 
/**
 * Version of the format: 1.
 */
version: number, 
/**
 * Name shown to users. At most 200 characters.
 */
name: string, 
/**
 * The eye.
 */
camera: CameraDescription, 
/**
 * How a page steers the camera. If left out: `look` where surfaces surround the camera, else `orbit`.
 */
navigation?: Navigation, 
/**
 * Surfaces. Shared, since edits never change it.
 */
geometry: Array<GeometryDescription>, 
/**
 * Lights, at most one of them an environment.
 */
lights: Array<LightDescription>, 
/**
 * Participating media; where they overlap their coefficients add up.
 */
media: Array<MediumDescription>, 
/**
 * How to render.
 */
render: RenderDescription, 
/**
 * How time goes on; matters only with keyframes.
 */
animation?: AnimationDescription, };

/**
 * A change to a scene. What is left out stays as it is; a list replaces the whole list.
 */
export type SceneEdit = { 
/**
 * The new camera.
 */
camera?: CameraDescription, 
/**
 * The camera's new exposure, after `camera`. Unit: EV. Range: −24 to 24.
 */
exposure_ev?: number, 
/**
 * All lights, the environment among them.
 */
lights?: Array<LightDescription>, 
/**
 * All media.
 */
media?: Array<MediumDescription>, 
/**
 * How to render.
 */
render?: RenderDescription, 
/**
 * The time to show. Unit: s. Range: 0 to 1e6.
 */
time_seconds?: number, 
/**
 * Whether time goes on from there; only a session has a clock.
 */
playing?: boolean, };

/**
 * Another scene is open.
 */
export type SceneMessage = { 
/**
 * Frames of this scene carry this number.
 */
epoch: number, 
/**
 * The scene's name.
 */
name: string, 
/**
 * The scene as it can be edited.
 */
description: SceneDescription, 
/**
 * What the planner knows about it.
 */
facts: Facts, 
/**
 * What was left out or approximated, one sentence each.
 */
warnings: Array<string>, 
/**
 * The clock, if something moves.
 */
clock?: ClockState, };

/**
 * Settings of the `screen_space` filter.
 */
export type ScreenSpace = { 
/**
 * How scattered light is spread over the picture.
 */
filter: ScreenSpaceFilter, 
/**
 * How widely a pixel's light is spread.
 */
spread: SpreadModel, 
/**
 * Side of the kernel between two levels of the picture. Range: 2, 4 or 6. Unit: pixel.
 */
kernel: number, 
/**
 * How `hierarchical` reads its levels.
 */
fetch: LevelFetch, 
/**
 * `hierarchical`: spreads are averaged by the luminance of what is spread.
 */
luminance_weighting: boolean, 
/**
 * `hierarchical`: light that is spread little stays out of coarse levels.
 */
masking: boolean, 
/**
 * `hierarchical`: the spreads themselves are blurred, which softens edges of depth.
 */
density_blur: boolean, 
/**
 * `hierarchical`: bright pixels that are spread little are filtered apart.
 */
separation: boolean, 
/**
 * Luminance above which they count as bright. Unit: W·m⁻²·sr⁻¹. Range: 0 to 1e6.
 */
separation_luminance: number, 
/**
 * Scattering depth below which they are spread little. Range: 0 to 100.
 */
separation_depth: number, 
/**
 * Light of lights that the media scatter once toward the eye is added, with its shadows, as
 * `single_scattering` marches it. Otherwise the media only glow.
 */
in_scatter: boolean, 
/**
 * Radiance that arrives in the media from everywhere, beside what the picture shows.
 * Unit: W·m⁻²·sr⁻¹. Range: 0 to 1e6.
 */
ambient: [number, number, number], };

/**
 * How scattered light is spread over the picture.
 */
export type ScreenSpaceFilter = "splat" | "hierarchical" | "gather";

/**
 * What the server says.
 */
export type ServerMessage = { "type": "welcome" } & Welcome | { "type": "scene" } & SceneMessage | { "type": "navigation" } & NavigationMessage | { "type": "camera" } & CameraMessage | { "type": "picked" } & PickedMessage | { "type": "darkness" } & DarknessMessage | { "type": "plan" } & PlanMessage | { "type": "stats" } & Stats | { "type": "notice" } & Notice | { "type": "error" } & ErrorMessage;

/**
 * Method of visibility.
 */
export type ShadowMode = "off" | "mapped" | "traced";

/**
 * How visibility toward lights is found.
 */
export type Shadows = { 
/**
 * Method.
 */
mode: ShadowMode, 
/**
 * Side of a shadow map. Unit: texel. Range: 16 to 8192.
 */
resolution: number, };

/**
 * Settings of the ray march.
 */
export type SingleScattering = { 
/**
 * Strata a ray, each sampled once. Range: 1 to 4096.
 */
steps: number, 
/**
 * Random position inside each stratum; otherwise its midpoint.
 */
jitter: boolean, 
/**
 * Side of the tile of pixels that share the strata of one ray: 1, 2, 4 or 8. Above 1, each pixel
 * takes its share of them and gathers the rest from its neighbours. 0 is what is faster on the device: 4
 * on a software driver, which errs by less than 1 % more, 1 on a GPU.
 */
interleave: number, 
/**
 * March one of every 2×2 pixels and interpolate between those that end at a pixel's distance; what
 * has none, or lies at an edge of a shaft, is marched itself. Every sample takes another of the four.
 */
half_resolution: boolean, 
/**
 * Half of the strata of lights with a position equiangular about them, weighted by the balance
 * heuristic: less noise near lights.
 */
equiangular: boolean, };

/**
 * A tessellated sphere.
 */
export type SphereGeometry = { 
/**
 * Name for people and messages. At most 200 characters.
 */
name?: string, 
/**
 * Unit: m.
 */
center: [number, number, number], 
/**
 * Unit: m. Range: 1e−6 to 1e6.
 */
radius: number, 
/**
 * Surface.
 */
material: MaterialDescription, 
/**
 * Placement; identity if left out.
 */
transform?: Transform, 
/**
 * Placement at which time, in order of time; replaces `transform`.
 */
keyframes?: Array<TransformKeyframe>, };

/**
 * A soft ball.
 */
export type SphereMedium = { 
/**
 * Name for people and messages. At most 200 characters.
 */
name?: string, 
/**
 * Scattering coefficient at density 1, together with `sigma_a`. Unit: m⁻¹.
 * Range: 0 to 1e6.
 */
sigma_s?: Rgb, 
/**
 * Absorption coefficient at density 1, together with `sigma_s`. Unit: m⁻¹.
 * Range: 0 to 1e6.
 */
sigma_a?: Rgb, 
/**
 * Extinction coefficient at density 1, together with `albedo`, instead of `sigma_s`
 * and `sigma_a`. Unit: m⁻¹. Range: 0 to 1e6.
 */
sigma_t?: Rgb, 
/**
 * Scattered share of `sigma_t`. Range: 0 to 1.
 */
albedo?: Rgb, 
/**
 * Henyey–Greenstein mean cosine, +1 forward. Range: −0.999 to 0.999.
 */
g: number, 
/**
 * Phase function, instead of `g`.
 */
phase?: PhaseDescription, 
/**
 * Emitted radiance per metre at density 1. Unit: W·m⁻³·sr⁻¹. Range: 0 to 1e9.
 */
emission: Rgb, 
/**
 * Factor on all coefficients and the emission. Range: 0 to 1e6.
 */
density_scale: number, 
/**
 * Unit: m.
 */
center: [number, number, number], 
/**
 * Unit: m. Range: 1e−6 to 1e6.
 */
radius: number, };

/**
 * A spot light's pose at one time.
 */
export type SpotKeyframe = { 
/**
 * Later than the keyframe before. Unit: s. Range: 0 to 1e6.
 */
time_seconds: number, 
/**
 * Unit: m. Linear in between.
 */
position: [number, number, number], 
/**
 * Axis of the cone, along propagation; any length above 1e−6. Turns along the shortest arc;
 * not opposite to the keyframe before.
 */
direction: [number, number, number], };

/**
 * Point light restricted to a cone, with glTF's angular falloff.
 */
export type SpotLightDescription = { 
/**
 * Name for people and messages. At most 200 characters.
 */
name?: string, 
/**
 * Unit: m.
 */
position: [number, number, number], 
/**
 * Axis of the cone, along propagation; any length above 1e−6.
 */
direction: [number, number, number], 
/**
 * On the axis. Unit: W·sr⁻¹. Range: 0 to 1e12.
 */
intensity: Rgb, 
/**
 * Full intensity inside. Unit: degree. Range: 0 to `outer_angle_degrees` − 0.01.
 */
inner_angle_degrees: number, 
/**
 * Dark outside. Unit: degree. Range: 0.1 to 89.9.
 */
outer_angle_degrees: number, 
/**
 * Distances below this count as this in 1/d². Unit: m. Range: 1e−4 to 1000.
 */
radius: number, 
/**
 * Whether surfaces block this light.
 */
casts_shadows: boolean, 
/**
 * Where it is at which time, in order of time; replaces the pose above.
 */
keyframes?: Array<SpotKeyframe>, };

/**
 * How widely a pixel's light is spread.
 */
export type SpreadModel = "premoze" | "exact_moments";

/**
 * About one frame.
 */
export type Stats = { 
/**
 * `frame_id` of the header.
 */
frame: number, 
/**
 * Accumulated samples a pixel.
 */
samples: number, 
/**
 * Whether the picture is final until something changes.
 */
converged: boolean, 
/**
 * Mean over pixels and channels of the transmittance to the first surface. Range: 0 to 1.
 */
mean_transmittance: number, 
/**
 * Mean luminance after exposure and curve, before encoding. Range: 0 to 1.
 */
mean_luminance: number, 
/**
 * Pixels that were not finite; anything above 0 is a fault.
 */
non_finite: number, 
/**
 * Pixels that were negative; anything above 0 is a fault.
 */
negative: number, 
/**
 * Pixels that a named clamp changed.
 */
clamped: number, 
/**
 * Time of each pass on the device.
 */
pass_times: Array<PassTime>, 
/**
 * Time of the whole frame on the device. Unit: µs.
 */
render_micros: number, 
/**
 * Time of the encoder. Unit: µs.
 */
encode_micros: number, 
/**
 * Length of the frame message. Unit: byte.
 */
bytes: number, 
/**
 * What transported the light.
 */
technique: string, 
/**
 * The scene's time that it shows, if something moves. Unit: s.
 */
time_seconds?: number, 
/**
 * Smoothed time from sending a frame to its acknowledgement. Unit: µs.
 */
round_trip_micros?: number, };

/**
 * What this server allows.
 */
export type StreamLimits = { 
/**
 * Largest picture. Unit: pixel.
 */
max_pixels: number, 
/**
 * Longest side of a picture. Unit: pixel.
 */
max_side: number, 
/**
 * Longest message. Unit: byte.
 */
max_message_bytes: number, 
/**
 * How long a dropped session can be resumed. Unit: s.
 */
resume_seconds: number, };

/**
 * What transports the light.
 */
export type Technique = "auto" | "single_scattering" | "instant_vpl" | "principal_ordinates" | "screen_space" | "reference";

/**
 * Scale, then rotation about x, then y, then z (the fixed axes), then translation.
 */
export type Transform = { 
/**
 * Unit: m.
 */
translation: [number, number, number], 
/**
 * About x, then y, then z. Unit: degree. Range: −36000 to 36000 each.
 */
rotation_degrees: [number, number, number], 
/**
 * Factors; magnitude 1e−6 to 1e6 each. A negative factor mirrors.
 */
scale: Scale, };

/**
 * A placement at one time.
 */
export type TransformKeyframe = { 
/**
 * Later than the keyframe before. Unit: s. Range: 0 to 1e6.
 */
time_seconds: number, 
/**
 * Placement at that time. In between translation and scale are linear and the rotation turns
 * along the shortest arc. No factor of the scale changes its sign from one to the next.
 */
transform: Transform, };

/**
 * Two lobes.
 */
export type TwoLobesPhase = { 
/**
 * Mean cosine of the forward lobe. Range: −0.999 to 0.999.
 */
g_forward: number, 
/**
 * Mean cosine of the backward lobe. Range: −0.999 to 0.999.
 */
g_backward: number, 
/**
 * Share of the light that the forward lobe scatters. Range: 0 to 1.
 */
forward_share: number, };

/**
 * A place to stand and a point to look at.
 */
export type ViewPoint = { 
/**
 * Unit: m.
 */
position: [number, number, number], 
/**
 * Unit: m.
 */
target: [number, number, number], };

/**
 * Says whether anyone can see the picture.
 */
export type Visible = { 
/**
 * False for a hidden tab.
 */
visible: boolean, };

/**
 * Answers the hello.
 */
export type Welcome = { 
/**
 * [`PROTOCOL_VERSION`].
 */
protocol: number, 
/**
 * Version of the server.
 */
version: string, 
/**
 * Secret name of this session, for `resume`.
 */
session: string, 
/**
 * Whether the session that was asked for goes on.
 */
resumed: boolean, 
/**
 * What renders.
 */
adapter: Adapter, 
/**
 * Built-in scenes, the default first.
 */
presets: Array<Preset>, 
/**
 * What this server allows.
 */
limits: StreamLimits, };
