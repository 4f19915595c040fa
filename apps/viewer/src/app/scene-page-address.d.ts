/** Address of `scene-page.html` as it is built; empty in the viewer as one file. */
declare module 'virtual:scene-page' {
  const address: string;
  export default address;
}
