import { type ComponentType, type LazyExoticComponent, lazy } from 'react';

/** Descriptions of the files in routes/, in the order of the index page. */
const DESCRIPTIONS = [
  {
    name: 'first-splat',
    title: 'A first splat',
    about: 'A file on the screen in ten lines: a canvas, a renderer, a source.',
  },
  {
    name: 'mesh-through-splats',
    title: 'A moving mesh',
    about: 'A ball moves through the scene: it hides splats behind it, and splats in front veil it.',
  },
  {
    name: 'two-clouds',
    title: 'Two clouds',
    about: 'One file twice, each with a transform and an opacity of its own, sorted together splat by splat.',
  },
  {
    name: 'instances',
    title: 'Instances',
    about: 'Hundreds of figures from one upload, each with a place and a tint of its own, sorted as one.',
  },
  {
    name: 'picking',
    title: 'Picking',
    about:
      'A click finds the exact splat under it: its row in the file, its depth and a point to put a marker on.',
  },
  {
    name: 'labels',
    title: 'Labels',
    about: 'drei’s Html in the scene: a label disappears while splats lie before it.',
  },
  {
    name: 'demand-loop',
    title: 'Drawing on demand',
    about: 'Frames are drawn on request, and none while nothing changes.',
  },
  {
    name: 'suspense',
    title: 'Suspense',
    about: 'A placeholder in the scene while a file is loading, and a progress bar over it.',
  },
  {
    name: 'several-views',
    title: 'Several views',
    about: 'One scene from three cameras side by side, each sorted for itself, uploaded once.',
  },
  {
    name: 'accuracy',
    title: 'Accuracy',
    about: 'Settings by name, or an outcome, for which settings are measured, chosen and explained.',
  },
  {
    name: 'colour',
    title: 'Colour',
    about:
      'Tint, brightness, opacity, how far colours depend on the view, and antialiasing: a prop for each.',
  },
  {
    name: 'clip',
    title: 'Clipping',
    about: 'A plane, a sphere or a box cuts the scene off, with a hard or a soft edge.',
  },
  {
    name: 'reveal',
    title: 'Revealing',
    about:
      'The scene appears from a point or from the camera, requests the frames it needs, and comes to rest.',
  },
  {
    name: 'selection',
    title: 'Selecting',
    about: 'A click selects the splats around it, by their rows in the file, and they are highlighted.',
  },
  {
    name: 'fog',
    title: 'Fog',
    about: 'The fog of the three.js scene hides splats as it does meshes.',
  },
  {
    name: 'depth-write',
    title: 'Writing depth',
    about: 'A transparent ring is drawn after the splats, and yet goes around the vase.',
  },
  {
    name: 'post-processing',
    title: 'Post-processing',
    about: 'Depth of field, bloom and temporal antialiasing over splats and meshes, in one image.',
  },
  {
    name: 'detail',
    title: 'Detail',
    about: 'A slider from all splats to one in 256: coarser ones stand for those that are left out.',
  },
  {
    name: 'file-drop',
    title: 'Files of visitors',
    about: 'A file that is dropped or chosen replaces the scene, and the camera moves to fit it.',
  },
  {
    name: 'gltf-scene',
    title: 'A glTF scene',
    about: 'One file with a mesh and splats, loaded by useGLTF and placed by its nodes.',
  },
  {
    name: 'own-data',
    title: 'Splats of your own',
    about: 'Splats that code makes of arrays, and gives other places and colours in every frame.',
  },
  {
    name: 'sequence',
    title: 'A sequence',
    about: 'Files that play one after the other, as a 4D capture does, with a pause and a place to seek.',
  },
  {
    name: 'annotations',
    title: 'Labels and distances',
    about: 'Labels hide where splats cover their points, and two clicks measure how far it is between them.',
  },
  {
    name: 'colliders',
    title: 'Physics',
    about: 'Balls fall on a coarse mesh that a worker makes of the splats.',
  },
  {
    name: 'wind-sway',
    title: 'An effect of your own',
    about: 'Wind in twenty lines of WGSL and a list of options, written outside of the packages.',
  },
  {
    name: 'nodes',
    title: 'Effects by nodes',
    about: 'Wind, a reveal and a lamp in three’s node language, TSL: a few lines each, and no shader.',
  },
] as const;

export interface Example {
  /** Name of its file in routes/, and of `?example=` in the address. */
  readonly name: string;
  readonly title: string;
  readonly about: string;
  readonly Component: LazyExoticComponent<ComponentType>;
  readonly loadSource: () => Promise<string>;
}

const modules = import.meta.glob<{ default: ComponentType }>('./routes/*.tsx');
const sources = import.meta.glob<string>('./routes/*.tsx', { query: '?raw', import: 'default' });

export const EXAMPLES: readonly Example[] = DESCRIPTIONS.map((description) => ({
  ...description,
  Component: lazy(modules[`./routes/${description.name}.tsx`]),
  loadSource: sources[`./routes/${description.name}.tsx`],
}));
