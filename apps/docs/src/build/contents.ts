// Contents of the site, in order: the sidebar, and the repository's documents that are whole pages.

/**
 * Documents of the repository that are whole pages, by path. Links to a document lead to its page.
 */
export const REPOSITORY_PAGES: Readonly<Record<string, string>> = {
  'README.md': 'project/overview.md',
  'ARCHITECTURE.md': 'project/architecture.md',
  'CONTRIBUTING.md': 'project/contributing.md',
  'SECURITY.md': 'project/security.md',
  'apps/docs/README.md': 'project/site.md',
  'apps/lab/README.md': 'project/lab.md',
  'apps/viewer/README.md': 'project/viewer.md',
  'docs/accuracy.md': 'reference/accuracy.md',
  'docs/browsers.md': 'reference/browsers.md',
  'docs/dependencies.md': 'project/dependencies.md',
  'docs/detail.md': 'reference/detail.md',
  'docs/effects.md': 'reference/effects.md',
  'docs/faults.md': 'project/faults.md',
  'docs/formats.md': 'reference/formats.md',
  'docs/framing.md': 'reference/framing.md',
  'docs/glossary.md': 'project/glossary.md',
  'docs/hard-cases.md': 'project/hard-cases.md',
  'docs/measurements.md': 'reference/measurements.md',
  'docs/three.md': 'project/three.md',
  'packages/core/README.md': 'packages/core.md',
  'packages/core/src/clouds/README.md': 'project/clouds.md',
  'packages/core/src/frame/README.md': 'project/frame.md',
  'packages/core/src/gpu/README.md': 'project/gpu.md',
  'packages/core/src/gpu/effects/README.md': 'project/effects.md',
  'packages/core/src/io/README.md': 'project/io.md',
  'packages/core/src/views/README.md': 'project/views.md',
  'packages/react/README.md': 'packages/react.md',
  'packages/scenes/README.md': 'packages/scenes.md',
  'packages/three/README.md': 'packages/three.md',
};

export interface Section {
  readonly text: string;
  readonly pages: readonly { readonly text: string; readonly page: string }[];
}

/** Sidebar contents, except examples and API, which are generated. */
export const SECTIONS: readonly Section[] = [
  {
    text: 'Guide',
    pages: [
      { text: 'First picture', page: 'guide/first-picture.md' },
      { text: 'Loading', page: 'guide/loading.md' },
      { text: 'Camera and orientation', page: 'guide/camera.md' },
      { text: 'Effects', page: 'guide/effects.md' },
      { text: 'Picking and rays', page: 'guide/picking.md' },
      { text: 'Errors and fallbacks', page: 'guide/errors.md' },
      { text: 'Rendering on servers', page: 'guide/servers.md' },
      { text: 'Accuracy, measured here', page: 'guide/accuracy.md' },
      { text: 'Performance, measured here', page: 'guide/performance.md' },
    ],
  },
  {
    text: 'Recipes',
    pages: [
      { text: 'Next.js', page: 'recipes/next.md' },
      { text: 'Post-processing', page: 'recipes/post-processing.md' },
      { text: 'Physics', page: 'recipes/physics.md' },
      { text: 'Your own data', page: 'recipes/own-data.md' },
      { text: 'drei', page: 'recipes/drei.md' },
      { text: 'Bundlers and the worker', page: 'recipes/bundlers.md' },
      { text: 'In a worker', page: 'recipes/worker.md' },
      { text: 'Hosting', page: 'recipes/hosting.md' },
    ],
  },
  {
    text: 'Packages',
    pages: [
      { text: '@websplatter/react', page: 'packages/react.md' },
      { text: '@websplatter/three', page: 'packages/three.md' },
      { text: '@websplatter/core', page: 'packages/core.md' },
      { text: '@websplatter/scenes', page: 'packages/scenes.md' },
    ],
  },
  {
    text: 'Reference',
    pages: [
      { text: 'Effects', page: 'reference/effects.md' },
      { text: 'File formats', page: 'reference/formats.md' },
      { text: 'What accuracy costs', page: 'reference/accuracy.md' },
      { text: 'Detail', page: 'reference/detail.md' },
      { text: 'First cameras', page: 'reference/framing.md' },
      { text: 'Measurements', page: 'reference/measurements.md' },
      { text: 'Browsers', page: 'reference/browsers.md' },
    ],
  },
  {
    text: 'Project',
    pages: [
      { text: 'Overview', page: 'project/overview.md' },
      { text: 'Viewer', page: 'project/viewer.md' },
      { text: 'Architecture', page: 'project/architecture.md' },
      { text: 'Words', page: 'project/glossary.md' },
      { text: 'From bytes to rows', page: 'project/io.md' },
      { text: 'Device, shaders and stages', page: 'project/gpu.md' },
      { text: 'Effects and automatic features', page: 'project/effects.md' },
      { text: 'Clouds on the GPU', page: 'project/clouds.md' },
      { text: 'Inside a frame', page: 'project/frame.md' },
      { text: 'Views', page: 'project/views.md' },
      { text: 'Inside three.js and React', page: 'project/three.md' },
      { text: 'Faults', page: 'project/faults.md' },
      { text: 'Hard cases', page: 'project/hard-cases.md' },
      { text: 'Lab: tests, benchmark, other renderers', page: 'project/lab.md' },
      { text: 'This site', page: 'project/site.md' },
      { text: 'Dependencies', page: 'project/dependencies.md' },
      { text: 'Security', page: 'project/security.md' },
      { text: 'Contributing', page: 'project/contributing.md' },
      { text: 'Changelog', page: 'project/changelog.md' },
    ],
  },
];

/** Sidebar sections by a page's folder. Collapsible groups would nest buttons. */
export const SIDEBARS: Readonly<Record<string, readonly string[]>> = {
  '/guide/': ['Guide', 'Recipes', 'Packages'],
  '/recipes/': ['Guide', 'Recipes', 'Packages'],
  '/examples/': ['Examples'],
  '/api/': ['API'],
  '/packages/': ['Packages', 'Reference', 'Project'],
  '/reference/': ['Packages', 'Reference', 'Project'],
  '/project/': ['Packages', 'Reference', 'Project'],
};
