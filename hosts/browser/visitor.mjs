// What a page gets to know of the machine that it is shown on.

/** What compiles WGSL here is the browser's own; its name is all that a page gets to know. */
export function compiler() {
  const brand = navigator.userAgentData?.brands.find(({ brand }) => !/not.?a.?brand/i.test(brand.replace(/\W/g, '')));
  return brand ? `${brand.brand} ${brand.version}` : navigator.userAgent;
}

/** The operating system, as the browser calls it. */
export function platform() {
  return navigator.userAgentData?.platform || navigator.platform || 'unknown';
}
