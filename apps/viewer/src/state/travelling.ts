/** Ways of moving through the scene instead of around it; each has its command. */
export const TRAVEL_NAMES = ['fly', 'walk'] as const;
export type TravelName = (typeof TRAVEL_NAMES)[number];

/** How the camera moves through the scene. */
export type Travelling =
  /** `speed`: 1 at first. */
  | { readonly by: 'fly'; readonly speed: number }
  /** `eyeHeight` above the ground, scene units. */
  | { readonly by: 'walk'; readonly eyeHeight: number };
