/** Code of shaders for an automatic feature. */
export interface FeatureShaders {
  /** Names of conditions (`@if(NAME)`) that guard its shader code; all false while it is off. */
  readonly conditions: readonly string[];
  /** Bindings that stages need for it, by their names in shaders. */
  readonly bindings: readonly string[];
}

/** By names of automatic features. Lists all effects: without conditions, they are in no shader. */
export const FEATURE_SHADERS: Readonly<Record<string, FeatureShaders>> = {
  harmonics: {
    conditions: ['SH_1', 'SH_2', 'SH_3', 'SH_F32', 'SH_F16', 'SH_U8', 'SH_PALETTE'],
    bindings: ['shRest'],
  },
  motion: { conditions: [], bindings: ['motion', 'motionReaches'] },
  isotropic: { conditions: ['ISOTROPIC'], bindings: [] },
  levels: {
    conditions: ['LEVELS', 'DILATED', 'STACKED'],
    bindings: ['links', 'thresholds'],
  },
  transform: { conditions: [], bindings: [] },
  instances: { conditions: ['INSTANCES'], bindings: ['pages'] },
  orthographic: { conditions: ['ORTHOGRAPHIC'], bindings: [] },
  'distance-order': { conditions: ['DISTANCE_ORDER'], bindings: [] },
  'depth-test': {
    conditions: ['DEPTH_TEST', 'DEPTH_LOGARITHMIC', 'MULTISAMPLED', 'REVERSED_DEPTH'],
    bindings: ['hostDepth', 'hostDepths', 'testedDepth'],
  },
  'depth-write': { conditions: ['DEPTH_LAYER'], bindings: ['depthLayer'] },
  fade: { conditions: ['FADED'], bindings: ['fade'] },
  'lower-resolution': { conditions: ['SCALED'], bindings: [] },
  tiles: { conditions: [], bindings: ['tileMasks'] },
};
