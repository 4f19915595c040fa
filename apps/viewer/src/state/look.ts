/** The background of the splats: that of the page's theme, or a colour as style sheets write it. */
export type Background = 'theme' | `#${string}`;

/** How the scene is looked at, besides from where. */
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
