import type { UpAxis } from './up-axis.ts';

/** Background of the splats: the theme's colour, or a CSS colour. */
export type Background = 'theme' | `#${string}`;

/** Projection and background of the picture. */
export interface Look {
  /** Field of view over the image's shorter side. */
  readonly fovDegrees: number;
  /** Parallel lines stay parallel: far things are shown as large as near ones. */
  readonly isOrthographic: boolean;
  readonly background: Background;
}

export const FIRST_LOOK: Look = { fovDegrees: 50, isOrthographic: false, background: 'theme' };

/** Fields of view that can be chosen. */
export const FOV_DEGREES = { min: 10, max: 120 } as const;

/** Ways of moving through the scene instead of around it; each has its command. */
export const TRAVEL_NAMES = ['fly', 'walk'] as const;
export type TravelName = (typeof TRAVEL_NAMES)[number];

/** How the camera moves through the scene. */
export type Travelling =
  /** `speed`: 1 at first. */
  | { readonly by: 'fly'; readonly speed: number }
  /** `eyeHeight` above the ground, scene units. */
  | { readonly by: 'walk'; readonly eyeHeight: number };

/** The camera, apart from its pose. */
export interface CameraState {
  /** Index of the scene's own camera that was chosen last. */
  readonly cameraIndex: number;
  /** Whether that camera itself is shown, not an orbit that went on from it. */
  readonly isOwnCamera: boolean;
  readonly isFlipped: boolean;
  /** The scene's axis that its first view shows upwards, or the nearest axis. */
  readonly firstUp: UpAxis;
  /** Whether the z axis of the drawn scene points up, not the y axis. */
  readonly isZUp: boolean;
  readonly look: Look;
  /** Null while the camera moves around the scene. */
  readonly travelling: Travelling | null;
  /** Progress of computing the ground to walk on, 0…1; null while none is computed. */
  readonly groundPart: number | null;
}

export const FIRST_CAMERA: CameraState = {
  cameraIndex: 0,
  isOwnCamera: false,
  isFlipped: false,
  firstUp: 'y',
  isZUp: false,
  look: FIRST_LOOK,
  travelling: null,
  groundPart: null,
};
