// The permitted imports. import-rule.test.ts enforces them; type-only imports count like any other.
//
// A line names what it may import, and only what stands above it, so there can be no circles.
// `name(types)` allows `import type` only; `name(tests)` allows only tests to import it. The test
// also fails where a folder has no line and where nothing needs an arrow any more.

export type Arrows = Readonly<Record<string, string>>;

/**
 * The tiers of packages/core/src: folders, and files at its root; a file `NAME.TIER.ts` belongs to
 * that tier wherever it lies. Tests and testing/ may import all of them, and nothing else may
 * import those.
 */
export const CORE_TIERS: Arrows = {
  /** Splats, cameras, settings and errors: computed and checked without bytes or a GPU. */
  data: '',
  /** File formats, and reading them in a worker. */
  io: 'data',
  /** The device, its memory, pipelines, the linker of shaders, and effects. */
  gpu: 'data',
  /** Stages: shaders, and the host side of each. */
  stages: 'gpu data',
  /** Splats on the GPU: planes, files' rows that become planes there, rays and colliders. */
  clouds: 'stages gpu io data',
  /** One frame: plan, buffers, the order of its stages, and the ledger of its effects. */
  frame: 'clouds stages gpu data',
  /** People's choices of effects: the interface of `@websplatter/core/effect-options`. */
  options: 'gpu data',
  /** The references: the right result of every stage, in float64, without a GPU. */
  reference: 'gpu data',
  /** Single stages of a frame, read back and held against the references. */
  inspect: 'reference frame clouds stages gpu data',
  /** Costs of settings and effects, in time and in error. */
  measure: 'reference frame clouds stages gpu data',
  /** Views: frames on a canvas or in another renderer. Measuring code is loaded on demand. */
  views: 'measure(types) frame clouds stages gpu data',
  /** Changing splats, framing them without a GPU, and writing them as files: the interface of `@websplatter/core/write`. */
  'write.ts': 'clouds io data',
  /** Scenes that the browser keeps: the interface of `@websplatter/core/keep`. */
  'keep.ts': 'io',
  /** Splats from arrays, edits of splats, and morphs: the interface of `@websplatter/core/own-data`. */
  'own-data.ts': 'clouds data',
  /** All workers in one script: the file `@websplatter/core/load-worker`. */
  'load-worker.ts': 'clouds io',
  /** Arguments of callers besides requests of frames. */
  'check-options.ts': 'clouds(types) data',
  /** The engine: one device, its clouds and its views. */
  'engine.ts': 'check-options.ts views measure frame clouds stages gpu io data',
  /** Checks options, and fetches the engine's code while a device is asked for. */
  'create-engine.ts': 'engine.ts check-options.ts stages gpu io data',
  /** The public interface. */
  'index.ts': 'create-engine.ts engine.ts(types) views measure frame clouds gpu io data',
};

/** The rooms of apps/viewer/src: folders, and the files of its pages. */
const VIEWER_ROOMS: Arrows = {
  /** The store, the names and keys of commands, plain types and the texts of links. */
  state: '',
  /** Controls, theme, focus, and numbers as words. */
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
  /** The gallery of hard cases. */
  'hard-cases': 'scene accuracy engine ui state',
  /** Values of splats, distances, crops and selections. */
  inspect: 'scene engine camera ui state',
  /** Annotations and their markers. */
  annotate: 'inspect engine camera ui state',
  /** Clip, tint, fog and others. */
  effects: 'inspect accuracy engine camera ui state',
  /** What pictures show instead of colours. */
  'view-modes': 'engine camera ui state',
  /** Flying, walking, gamepads, saved views and paths. */
  navigate: 'view-modes annotate engine camera ui state',
  /** Scenes, pages, pictures, videos and links to take away. */
  share: 'navigate annotate scene engine camera ui state',
  /** The page: toolbar, keys, help, messages and panels. */
  app: 'share navigate view-modes effects annotate inspect scene hud accuracy engine camera ui state',
  'viewer-page.tsx': 'app share view-modes effects engine ui state',
  'gallery-page.tsx': 'viewer-page.tsx app hard-cases engine',
  'main.ts': 'gallery-page.tsx viewer-page.tsx engine ui',
};

/** The tiers of each package that has some, by its root. */
export const TIERS: Readonly<Record<string, Arrows>> = {
  'packages/core/src/': CORE_TIERS,
  'apps/viewer/src/': VIEWER_ROOMS,
};

/** Packages and apps by folder name. Each line agrees with the dependencies of its package.json. */
export const PACKAGES: Arrows = {
  /** Chores of this repository. */
  tools: '',
  /** WGSL only. */
  shaders: '',
  /** The engine. */
  core: 'shaders node(tests) scenes(tests)',
  /** Scenes made by code. */
  scenes: 'core',
  /** WebGPU and files in Node. */
  node: 'core',
  /** Scenes that break splat renderers, and the right result of each. */
  hardcases: 'core node(tests)',
  /** Splats in three.js. */
  three: 'core node(tests)',
  /** Splats in react-three-fiber. */
  react: 'three core',
  /** Charts and tables of measurements, for the terminal and for pages. */
  charts: 'core',
  /** The command line. */
  cli: 'charts hardcases node scenes core',
  /** Colours, copying, saving and addresses of the apps. */
  kit: 'core',
  /** The viewer; nothing imports an app. */
  viewer: 'kit charts hardcases scenes core',
  /** Examples for react-three-fiber. */
  examples: 'react scenes core',
  /** The documentation site, with examples that readers edit. */
  docs: 'react three scenes core',
  /** Hard cases and benchmark in any browser, and this project beside other renderers. */
  lab: 'kit charts hardcases three scenes node core tools',
  /** Apps and packages in a browser. */
  e2e: 'tools(tests) react(tests) three(tests) hardcases(tests) scenes(tests) core(tests)',
};

/** Files that reach into another package by path, and why. Others import a package's exports. */
export const PATH_EXCEPTIONS: Readonly<Record<string, string>> = {
  'apps/lab/vite.config.ts': 'asks which version it builds, which no browser runs',
  'apps/lab/src/overview-page.tsx': 'leads to the licences as the viewer does; apps export nothing',
  'packages/hardcases/src/host-mutations.gpu.test.ts':
    'replaces modules inside of core, to show that hard cases fail without them',
  'packages/hardcases/src/mutations.test.ts': 'looks for lines in shaders, which no package exports',
  'packages/cli/bin/websplatter.js': 'builds itself where a clone has no build yet',
  'packages/cli/src/machine.ts':
    'names version and commit as the builds of apps do, and is bundled: no package that ships imports tools',
  'apps/viewer/vite.config.ts': "strips shaders as the packages' build does, which no browser runs",
  'apps/docs/src/build/examples.ts': 'shows the examples and their sources; apps export nothing',
  'apps/docs/src/build/kit.ts': "builds the examples' scenes beside what they import; apps export nothing",
  'e2e/wgpu/shaders.ts': "compiles every variant of core's shaders, which core does not export",
  'e2e/react-streaming.test.ts': "serves a streamed SOG, which core's tests alone write",
  'e2e/viewer-page-file.test.ts': 'unpacks a zip, which no package offers',
  'e2e/viewer-modes.test.ts': "draws the viewer's own effects in float64; apps export nothing",
  'e2e/dev-server.test.ts': 'starts the development servers of apps, which export nothing',
  'e2e/examples.test.ts': "draws the examples' own scene and effect in float64; apps export nothing",
};
