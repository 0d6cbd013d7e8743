// A Vulkan layer that claims two features of arrays for drivers without them, and asks the driver for neither.
//
// Dawn takes no adapter that cannot index arrays of images by a number of the shader's own. Mesa's llvmpipe could not before
// version 23, and no shader of Isophote does it. One instance at a time, which is what a host has.
//
//   cc -shared -fPIC -O1 -o libclaim.so claim.c
//   VK_LAYER_PATH=hosts/layer VK_INSTANCE_LAYERS=VK_LAYER_ISOPHOTE_claim node hosts/node/play.mjs …
//
// Declared here is the little of vulkan_core.h and vk_layer.h that it takes, so that no headers need be installed.

#include <stddef.h>
#include <stdint.h>
#include <string.h>

typedef void (*Function)(void);
typedef Function (*GetProc)(void *, const char *);

// VkBaseOutStructure: how every structure of Vulkan begins.
typedef struct Base { uint32_t type; struct Base *next; } Base;
typedef struct Link { struct Link *next; GetProc instance_proc; GetProc other_proc; } Link;
// VkLayerInstanceCreateInfo and VkLayerDeviceCreateInfo.
typedef struct { Base base; uint32_t function; Link *link; } LayerInfo;
// VkPhysicalDeviceFeatures is 55 numbers.
typedef struct { uint32_t all[55]; } Features;
typedef struct { Base base; Features features; } Features2;
typedef struct {
    Base base;
    uint32_t flags, queues;
    const void *queue_infos;
    uint32_t layers;
    const char *const *layer_names;
    uint32_t extensions;
    const char *const *extension_names;
    Features *features;
} DeviceInfo;
typedef struct { uint32_t type; void *next; uint32_t version; GetProc instance, device, physical; } Negotiation;

enum { LOADER_INSTANCE = 47, LOADER_DEVICE = 48, FEATURES_2 = 1000059000, INITIALIZATION_FAILED = -3 };
// shaderSampledImageArrayDynamicIndexing, shaderStorageImageArrayDynamicIndexing.
enum { SAMPLED = 34, STORAGE = 36 };

static GetProc next_instance_proc, next_device_proc;
static void *instance_of;
// Asked for while the instance is made: later the loader's answer would be this layer again.
static void (*next_features)(void *, Features *);
static void (*next_features2)(void *, Features2 *);

static void claim(Features *features) { features->all[SAMPLED] = features->all[STORAGE] = 1; }

static LayerInfo *link_of(const Base *info, uint32_t type) {
    for (Base *at = info->next; at; at = at->next)
        if (at->type == type && ((LayerInfo *)at)->function == 0) return (LayerInfo *)at;
    return NULL;
}

static int32_t create_instance(const Base *info, const void *allocator, void **instance) {
    LayerInfo *layer = link_of(info, LOADER_INSTANCE);
    if (!layer) return INITIALIZATION_FAILED;
    next_instance_proc = layer->link->instance_proc;
    layer->link = layer->link->next;
    int32_t (*next)(const Base *, const void *, void **) = (void *)next_instance_proc(NULL, "vkCreateInstance");
    int32_t result = next(info, allocator, instance);
    if (result != 0) return result;
    instance_of = *instance;
    next_features = (void *)next_instance_proc(instance_of, "vkGetPhysicalDeviceFeatures");
    next_features2 = (void *)next_instance_proc(instance_of, "vkGetPhysicalDeviceFeatures2");
    return result;
}

static int32_t create_device(void *adapter, DeviceInfo *info, const void *allocator, void **device) {
    LayerInfo *layer = link_of(&info->base, LOADER_DEVICE);
    if (!layer) return INITIALIZATION_FAILED;
    next_device_proc = layer->link->other_proc;
    GetProc proc = layer->link->instance_proc;
    layer->link = layer->link->next;
    // The driver is asked for what it has.
    Features *features = info->features;
    for (Base *at = info->base.next; at; at = at->next)
        if (at->type == FEATURES_2) features = &((Features2 *)at)->features;
    Features asked;
    if (features) {
        asked = *features;
        features->all[SAMPLED] = features->all[STORAGE] = 0;
    }
    int32_t (*next)(void *, DeviceInfo *, const void *, void **) = (void *)proc(instance_of, "vkCreateDevice");
    int32_t result = next(adapter, info, allocator, device);
    if (features) *features = asked;
    return result;
}

static void features(void *adapter, Features *found) {
    next_features(adapter, found);
    claim(found);
}

static void features2(void *adapter, Features2 *found) {
    next_features2(adapter, found);
    claim(&found->features);
}

static Function device_proc(void *device, const char *name) { return next_device_proc(device, name); }

static Function instance_proc(void *instance, const char *name) {
    static const struct { const char *name; Function own; } OWN[] = {
        { "vkCreateInstance", (Function)create_instance },
        { "vkCreateDevice", (Function)create_device },
        { "vkGetPhysicalDeviceFeatures", (Function)features },
        { "vkGetPhysicalDeviceFeatures2", (Function)features2 },
        { "vkGetPhysicalDeviceFeatures2KHR", (Function)features2 },
        { "vkGetInstanceProcAddr", (Function)instance_proc },
        { "vkGetDeviceProcAddr", (Function)device_proc },
    };
    for (size_t k = 0; k < sizeof OWN / sizeof *OWN; k++)
        if (strcmp(OWN[k].name, name) == 0) return OWN[k].own;
    return next_instance_proc ? next_instance_proc(instance, name) : NULL;
}

int32_t vkNegotiateLoaderLayerInterfaceVersion(Negotiation *negotiation) {
    negotiation->version = 2;
    negotiation->instance = instance_proc;
    negotiation->device = device_proc;
    negotiation->physical = NULL;
    return 0;
}
