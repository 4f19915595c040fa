// The permitted imports. module-rules.test.ts enforces them; type-only imports count like any other.
//
// Each line lists the names that its folder may import. Only names of lines above are possible, so
// there are no cycles. `name(types)` allows `import type` only; `name(tests)` allows imports by tests
// only. The test also fails if a folder has no line, or if no import needs an arrow.

export type Arrows = Readonly<Record<string, string>>;

/**
 * The tiers of packages/core/src: folders, and files at its root. A file `NAME.TIER.ts` belongs to
 * that tier in any folder. Tests and testing/ may import all tiers; only they may import testing/.
 */
export const CORE_TIERS: Arrows = {
  /** Splats, cameras, settings and errors: computed and checked without bytes or a GPU. */
  data: '',
  /** What a cloud can have, a folder each: shaders, and files of other tiers, which name them: `NAME.TIER.ts`. */
  features: '',
  /** File formats, and reading them in a worker. */
  io: 'data',
  /** The device, its memory, pipelines, the shader linker, and effects. */
  gpu: 'features data',
  /** Stages: shaders, and the host side of each. */
  stages: 'features gpu data',
  /** Splats on the GPU: planes, uploaded rows that become planes, rays and colliders. */
  clouds: 'stages gpu io data',
  /** One frame: plan, buffers, the order of its stages, and the ledger of its effects. */
  frame: 'clouds stages gpu data',
  /** First cameras: samples of clouds and of splats in memory, and the camera that shows them best. */
  framing: 'frame clouds stages gpu io data',
  /** Choices for effects in user interfaces, exported as `@websplatter/core/effect-options`. */
  options: 'gpu data',
  /** Float64 references of every stage, without a GPU. */
  reference: 'gpu data',
  /** Single stages of a frame, read back and compared with the references. */
  inspect: 'reference frame clouds stages gpu data',
  /** Costs of settings and effects, in time and in error. */
  measure: 'reference frame clouds stages gpu data',
  /** Views: frames on a canvas or in another renderer. Measuring code is loaded on demand. */
  views: 'measure(types) frame clouds stages gpu data',
  /** Edits splats, frames them without a GPU and writes files, exported as `@websplatter/core/write`. */
  'write.ts': 'framing io data',
  /** Scenes in the browser's storage, exported as `@websplatter/core/keep`. */
  'keep.ts': 'io',
  /** Splats from arrays, edits, morphs and bones, exported as `@websplatter/core/own-data`. */
  'own-data.ts': 'clouds data',
  /** Opened files of frames, exported as `@websplatter/core/frames`. */
  'frames.ts': 'io',
  /** Splats from images and text, exported as `@websplatter/core/make`. */
  'make.ts': 'data',
  /** All workers in one script, exported as `@websplatter/core/load-worker`. */
  'load-worker.ts': 'framing clouds io',
  /** Checks arguments other than frame requests. */
  'check-options.ts': 'clouds(types) data',
  /** The engine: one device, its clouds and its views. */
  'engine.ts': 'check-options.ts views measure frame clouds stages gpu io data',
  /** Checks options, and fetches the engine's code while a device is requested. */
  'create-engine.ts': 'engine.ts check-options.ts stages gpu io data',
  /** Frames taken apart and engines changed for tests, exported as `@websplatter/core/inspect`. */
  'inspect.ts': 'create-engine.ts engine.ts(types) inspect clouds stages gpu data',
  /** The public interface. */
  'index.ts': 'create-engine.ts engine.ts(types) views measure framing frame clouds gpu io data',
};

/** Allowed imports in apps/viewer/src: its folders, and the files of its pages. */
const VIEWER_ROOMS: Arrows = {
  /** The store, the names and keys of commands, plain types and the texts of links. */
  state: '',
  /** Controls of panels, focus, and words for figures. */
  ui: 'state',
  /** Poses, orbit controls, and the camera that a frame is drawn with. */
  camera: 'ui state',
  /** The viewer without its interface: GPU session, loading, first view, drawing. */
  engine: 'camera ui state',
  /** Presets and their cost, measuring, comparing, the error map. */
  accuracy: 'engine ui state',
  /** Figures, charts and copies of them. */
  hud: 'engine ui state',
  /** The files of a scene, and the worker that reads them again. */
  scene: 'engine camera ui state',
  /** Values of splats, distances, crops and selections. */
  inspect: 'scene engine camera ui state',
  /** Annotations and their markers. */
  annotate: 'inspect engine camera state',
  /** Clip, tint, fog and others. */
  effects: 'inspect accuracy engine camera ui state',
  /** Modes that show depth, cost or other data instead of colours. */
  'view-modes': 'engine camera state',
  /** Flying, walking, gamepads, saved views and paths. */
  navigate: 'view-modes annotate engine camera ui state',
  /** Projects, and the work on scenes that the browser keeps. */
  project: 'navigate effects inspect engine state',
  /** Saves and shares scenes, pages, pictures, videos and links. */
  share: 'project navigate annotate scene engine camera ui state',
  /** The strip of the camera path, and files of paths. */
  path: 'share navigate engine camera ui state',
  /** The page: toolbar, keys, help, messages and panels. */
  app: 'path share project navigate view-modes effects annotate inspect scene hud accuracy engine camera ui state',
  'viewer-page.tsx': 'app share view-modes effects engine ui state',
  'main.ts': 'viewer-page.tsx engine',
};

/** The tiers of each package that has tiers, by its root. */
export const TIERS: Readonly<Record<string, Arrows>> = {
  'packages/core/src/': CORE_TIERS,
  'apps/viewer/src/': VIEWER_ROOMS,
};

/** Packages and apps by folder name. Each line agrees with the dependencies of its package.json. */
export const PACKAGES: Arrows = {
  /** Tools for developing this repository. */
  tools: '',
  /** WGSL only. */
  shaders: '',
  /** The engine. */
  core: 'shaders node(tests) scenes(tests)',
  /** Scenes made by code. */
  scenes: 'core',
  /** WebGPU and files in Node. */
  node: 'core',
  /** Scenes that break splat renderers with the right result of each, and soaks of random frames. */
  conformance: 'core node(tests)',
  /** Splats in three.js. */
  three: 'core node(tests)',
  /** Splats in react-three-fiber. */
  react: 'three core',
  /** Charts and tables of measurements, for the terminal and for pages. */
  charts: 'core',
  /** The command line. */
  cli: 'charts conformance node scenes core',
  /** Colours, buttons, number formats, images, storage and addresses of the apps. */
  kit: 'conformance core',
  /** The viewer; nothing imports an app. */
  viewer: 'kit charts conformance scenes core',
  /** Examples for react-three-fiber. */
  examples: 'react scenes core',
  /** The documentation site, with examples that readers edit. */
  docs: 'react three scenes core',
  /** Hard cases and benchmark in any browser, and this project beside other renderers. */
  lab: 'kit charts conformance react three scenes node core tools',
  /** Apps and packages in a browser. */
  e2e: 'tools(tests) react(tests) three(tests) conformance(tests) node(tests) scenes(tests) core(tests)',
};

/**
 * Files that refer to another package's files by path, with reasons. Other files import a package's
 * exports.
 */
export const PATH_EXCEPTIONS: Readonly<Record<string, string>> = {
  'apps/lab/vite.config.ts': 'asks which version it builds, which no browser runs',
  'apps/lab/src/peers/recorded-tables.tsx': 'shows files in the format of the site; apps export nothing',
  'apps/lab/src/peers/runner/evidence.ts': 'writes files in the format of the site; apps export nothing',
  'apps/lab/src/peers/runner/evidence.test.ts': 'reads those files as the site does; apps export nothing',
  'packages/tools/src/packed-docs.ts': 'packs pages as the site assembles them; apps export nothing',
  'packages/tools/evidence.test.mjs': 'reads evidence as the site does; apps export nothing',
  'apps/lab/src/overview-page.tsx': 'leads to the licences as the viewer does; apps export nothing',
  'packages/conformance/src/host-mutations.gpu.test.ts':
    'replaces modules inside of core, to show that hard cases fail without them',
  'packages/conformance/src/mutations.test.ts': 'looks for lines in shaders, which no package exports',
  'packages/cli/bin/websplatter.js': 'builds itself where a clone has no build yet',
  'packages/cli/src/machine.ts':
    'names version and commit as the builds of apps do, and is bundled: no package that ships imports tools',
  'apps/viewer/vite.config.ts': "strips shaders as the packages' build does, which no browser runs",
  'apps/docs/src/build/examples.ts': 'shows the examples and their sources; apps export nothing',
  'apps/docs/src/build/kit.ts': "builds the examples' scenes beside what they import; apps export nothing",
  'e2e/wgpu/shaders.ts': "compiles every variant of core's shaders, which core does not export",
  'e2e/wgpu/together.ts': 'compiles the shaders of everything in one frame, which core does not export',
  'e2e/react-streaming.test.ts': "serves a streamed SOG, which core's tests alone write",
  'e2e/viewer-page-file.test.ts': 'unpacks a zip, which no package offers',
  'e2e/viewer-modes.test.ts': "draws the viewer's own effects in float64; apps export nothing",
  'e2e/dev-server.test.ts': 'starts the development servers of apps, which export nothing',
  'e2e/examples.test.ts': "draws the examples' own scene and effect in float64; apps export nothing",
};
