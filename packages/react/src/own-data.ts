'use client';

// For applications that install only this package.
export {
  type EditedRows,
  type EditedValues,
  editsOf,
  type MakeSplatDataOptions,
  makeSplatData,
  type RowRange,
  type SplatArrays,
  SplatEdits,
} from '@websplatter/three/own-data';
