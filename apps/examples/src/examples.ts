import { type ComponentType, type LazyExoticComponent, lazy } from 'react';

/** Descriptions of the files in routes/, in the order of the index page. */
const DESCRIPTIONS = [
  {
    name: 'first-splat',
    title: 'A first splat',
    about: 'A file on the screen in ten lines: a canvas, a renderer, a source.',
    alt: 'A round table in a meadow, with a vase of pampas grass, a bottle, bread and fruit',
  },
  {
    name: 'mesh-through-splats',
    title: 'A moving mesh',
    about: 'A ball moves through the scene: it hides splats behind it, and splats in front veil it.',
    alt: 'A red ball that floats before the table of the still life',
  },
  {
    name: 'two-clouds',
    title: 'Two clouds',
    about: 'One file twice, each with a transform and an opacity of its own, sorted together splat by splat.',
    alt: 'Two rings in rainbow colours, linked as in a chain',
  },
  {
    name: 'x-ray',
    title: 'Seeing through',
    about: 'A cloud of a higher render order is drawn over all others, as if they were of glass.',
    alt: 'An island, and in its mountain a knot in rainbow colours that shines through the rock',
  },
  {
    name: 'instances',
    title: 'Instances',
    about: 'Hundreds of figures from one upload, each with a place and a tint of its own, sorted as one.',
    alt: 'A field of hundreds of small pawns in all colours, in spirals',
  },
  {
    name: 'picking',
    title: 'Picking',
    about:
      'A click finds the exact splat under it: its row in the file, its depth and a point to put a marker on.',
    alt: 'Seven pawns in a bow, each of another colour, and a pink marker on one of them',
  },
  {
    name: 'labels',
    title: 'Labels',
    about: 'drei’s Html in the scene: a label disappears while splats lie before it.',
    alt: 'The still life with labels: one before the vase, one above the table',
  },
  {
    name: 'demand-loop',
    title: 'Drawing on demand',
    about: 'Frames are drawn on request, and none while nothing changes.',
    alt: 'A trefoil knot in rainbow colours, the number of frames drawn, and a button for one more',
  },
  {
    name: 'suspense',
    title: 'Suspense',
    about: 'A placeholder in the scene while a file is loading, and a progress bar over it.',
    alt: 'Wireframes of a table, a vase and a bowl, and a progress bar below them',
  },
  {
    name: 'several-views',
    title: 'Several views',
    about: 'One scene from three cameras side by side, each sorted for itself, uploaded once.',
    alt: 'The still life three times, side by side: from the front, the left and above',
  },
  {
    name: 'accuracy',
    title: 'Accuracy',
    about: 'Settings by name, or an outcome, for which settings are measured, chosen and explained.',
    alt: 'An island with a snowy mountain, and a list of accuracies below it',
  },
  {
    name: 'colour',
    title: 'Colour',
    about:
      'Tint, brightness, opacity, how far colours depend on the view, and antialiasing: a prop for each.',
    alt: 'The still life in the warm light of an orange tint',
  },
  {
    name: 'fade',
    title: 'Fading a cloud',
    about:
      'A faint cloud keeps its insides hidden if it fades as a whole, unlike one whose splats are faint.',
    alt: 'Two knots before dark stripes: the left one is as dense as ever, and the stripes show through the right one',
  },
  {
    name: 'clip',
    title: 'Clipping',
    about: 'A plane, a sphere or a box cuts the scene off, with a hard or a soft edge.',
    alt: 'The left half of the still life: the right one is cut off at a soft edge',
  },
  {
    name: 'volumes',
    title: 'Volumes',
    about:
      'Volumes as objects of the scene erase, light and lift the splats in them, and are dragged by controls.',
    alt: 'The still life with a bite out of the bread, a warm light on the vase, and the bottle in the air',
  },
  {
    name: 'exploded-view',
    title: 'An exploded view',
    about:
      'Four half-spaces lift what is above them: each meets the splats where the others have moved them.',
    alt: 'An island in five floating layers: sea, beach, woods, rocks, and a snowy summit on top',
  },
  {
    name: 'tractor-beam',
    title: 'Volumes of a moving mesh',
    about: 'A flying saucer pulls flowers up: its beam is a volume that is a child of the mesh.',
    alt: 'A flying saucer above a meadow: the flowers in its beam rise towards it',
  },
  {
    name: 'spring',
    title: 'A spring',
    about:
      'A spotlight swings to the figure that is chosen: a damped spring in ten lines, without a library.',
    alt: 'Seven pawns in the dark, of which one is lit',
  },
  {
    name: 'reveal',
    title: 'Revealing',
    about:
      'The scene appears from a point or from the camera, requests the frames it needs, and comes to rest.',
    alt: 'The whole island with its snowy mountain, at the end of its reveal',
  },
  {
    name: 'selection',
    title: 'Selecting',
    about: 'A click selects the splats around it, by their rows in the file, and they are highlighted.',
    alt: 'Seven pawns in a bow: what lies near one of them is highlighted in orange',
  },
  {
    name: 'hide-parts',
    title: 'Hiding parts',
    about:
      'A ball and a box find the rows of each figure; a click or a checkbox makes them faint, and shows them again.',
    alt: 'Seven pawns in a bow, of which three are so faint that only their shapes are left',
  },
  {
    name: 'fog',
    title: 'Fog',
    about: 'The fog of the three.js scene hides splats as it does meshes.',
    alt: 'The still life in fog, and red balls that fade with the distance',
  },
  {
    name: 'shadows',
    title: 'Shadows',
    about: 'Splats cast shadows on a floor and on each other, and a ball casts one on them.',
    alt: 'Seven figures in a bow on a round floor, and a red ball above it, with shadows to one side',
  },
  {
    name: 'relight',
    title: 'Relighting',
    about:
      'A lamp and the moon light splats as they light the floor, by normals of the splats’ shortest axes.',
    alt: 'Seven figures at night around a small lamp, orange on the side of the lamp and blue behind',
  },
  {
    name: 'depth-write',
    title: 'Writing depth',
    about: 'A transparent ring is drawn after the splats, and yet goes around the vase.',
    alt: 'A blue ring around the vase of the still life, which hides its far side',
  },
  {
    name: 'post-processing',
    title: 'Post-processing',
    about: 'Depth of field, bloom and temporal antialiasing over splats and meshes, in one image.',
    alt: 'A glowing ball on the table, before a background out of focus',
  },
  {
    name: 'detail',
    title: 'Detail',
    about: 'A slider from all splats to one in 256: coarser ones stand for those that are left out.',
    alt: 'The still life in coarse, blurred splats',
  },
  {
    name: 'file-drop',
    title: 'Files of visitors',
    about: 'A file that is dropped or chosen replaces the scene, and the camera moves to fit it.',
    alt: 'A ring in rainbow colours, and a button below it that chooses a file',
  },
  {
    name: 'gltf-scene',
    title: 'A glTF scene',
    about: 'One file with a mesh and splats, loaded by useGLTF and placed by its nodes.',
    alt: 'A grey column through a lying ring in rainbow colours',
  },
  {
    name: 'own-data',
    title: 'Splats of your own',
    about: 'Splats that code makes of arrays, and gives other places and colours in every frame.',
    alt: 'A flower of thousands of dots in spirals, orange in the middle and blue outside',
  },
  {
    name: 'text-and-image',
    title: 'Text and an image',
    about: 'A word before a picture, both made of flat splats: one for each of their pixels.',
    alt: 'A sunset over hills, made of splats and seen from the right, and the word Splats before it',
  },
  {
    name: 'text-dust',
    title: 'Words of dust',
    about: 'A word of splats that settles out of dust: nodes give each splat a way and a time of its own.',
    alt: 'The word Splats in blue, whose last letters are still orange dust',
  },
  {
    name: 'ripples',
    title: 'Ripples in an image',
    about:
      'A click drops a stone into a picture of splats: waves move and light them, in six lines of nodes.',
    alt: 'The tiles of a pool, seen at a slant, with rings of waves around a point',
  },
  {
    name: 'moving-scene',
    title: 'A moving scene',
    about: 'A fountain in one set of splats, which come, go and fly by polynomials of the time.',
    alt: 'A fountain of pale blue drops that rise in a column and fall to all sides',
  },
  {
    name: 'moments',
    title: 'Moments of a moving scene',
    about: 'One firework at five times beside each other: each cloud of the same data has a time of its own.',
    alt: 'A firework five times in the night sky, from the first spark to the widest bloom',
  },
  {
    name: 'morph',
    title: 'A morph',
    about: 'A globe that unrolls into its map: two clouds, and a number that goes from one to the other.',
    alt: 'A globe with seas and continents, half unrolled into a map',
  },
  {
    name: 'bones',
    title: 'Bones',
    about:
      'Eight bones of a three.js skeleton bend an arm of splats, with weights that are made of distances.',
    alt: 'A red arm with pale rings that bends to the right, and a chain of eight blue bones in it',
  },
  {
    name: 'gpu-particles',
    title: 'Particles of the GPU',
    about: 'Two galaxies pass each other: a compute shader moves their 40,000 stars, and no CPU sees them.',
    alt: 'An orange and a blue galaxy that tear long, curved arms of stars out of each other',
  },
  {
    name: 'sequence',
    title: 'A sequence',
    about: 'Files that play one after the other, as a 4D capture does, with a pause and a place to seek.',
    alt: 'A ring in rainbow colours that waves up and down',
  },
  {
    name: 'frames-file',
    title: 'A file of frames',
    about: 'One file with all frames of a moving scene: it plays while it loads, and each frame is a scene.',
    alt: 'A blue and orange bird in flight, and a row of small ones behind it, each with its wings elsewhere',
  },
  {
    name: 'annotations',
    title: 'Labels and distances',
    about: 'Labels hide where splats cover their points, and two clicks measure how far it is between them.',
    alt: 'The still life with labels at the bowl and the table, and a line between two points, 63.5 cm long',
  },
  {
    name: 'colliders',
    title: 'Physics',
    about: 'Balls fall on a coarse mesh that a worker makes of the splats.',
    alt: 'Eight orange balls that have come to rest on the table of the still life',
  },
  {
    name: 'depth-of-field',
    title: 'Depth of field',
    about: 'A lens with an aperture: what is nearer or farther than the depth in focus is blurred.',
    alt: 'A bow of pawns in all colours: a sharp green one, a blurred red one close by, and soft ones behind',
  },
  {
    name: 'scroll-focus',
    title: 'Focus by scrolling',
    about: 'The page’s scroll position moves the focus of a lens from the first flowers to the last.',
    alt: 'A meadow at eye level: sharp flowers, and blurred ones before and behind them',
  },
  {
    name: 'wind-sway',
    title: 'An effect of your own',
    about: 'Wind in twenty lines of WGSL and a list of options, written outside of the packages.',
    alt: 'Red, yellow, blue and white flowers that bend in the wind',
  },
  {
    name: 'nodes',
    title: 'Effects by nodes',
    about: 'Wind, a reveal and a lamp in three’s node language, TSL: a few lines each, and no shader.',
    alt: 'The still life in the dark, lit by a small lamp above the table',
  },
  {
    name: 'tsl-texture',
    title: 'A slide projector by nodes',
    about: 'An image thrown onto splats: nodes read a texture where its light falls.',
    alt: 'The still life in the dark, under the colours of a round window of stained glass',
  },
  {
    name: 'tsl-storage',
    title: 'A game of life on a ring',
    about:
      'A value per row: a compute pass writes a storage buffer, and nodes read it by the row of each splat.',
    alt: 'A dark ring of thousands of balls, on which patterns of yellow and red cells glow',
  },
] as const;

export interface Example {
  /** Name of its file in routes/, and value of `?example=` in the URL. */
  readonly name: string;
  readonly title: string;
  readonly about: string;
  /** Describes thumbnails/NAME.jpg, which shows the example at rest. */
  readonly alt: string;
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
